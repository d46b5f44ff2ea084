"""Conversions between ROS messages and the plain values of the agent. The only module here that knows ROS types."""

import math
from dataclasses import dataclass, replace
from typing import Any, Dict, Iterable, List, Optional, Sequence, Tuple, Union

import numpy as np
import rospy
from adhoc_communication.msg import (
    ExpAuction,
    ExpAuctionElement,
    ExpCluster,
    ExpClusterElement,
    ExpFrontier,
    ExpFrontierElement,
    MmListOfPoints,
    MmPoint,
)
from geometry_msgs.msg import Point, PointStamped, Quaternion
from move_base_msgs.msg import MoveBaseGoal
from nav_msgs.msg import GridCells, OccupancyGrid

from explorer.auction_result import Offer
from explorer.errors import MapError
from explorer.foreign import Element, Key, rigid_transform
from explorer.grid import OccupancyMap
from explorer.messages import PAPER_UNIT, Auction, Bid, SendAuction, SendFrontiers
from explorer.msg import (
    ExplorationBid,
    ExplorationLeftover,
    ExplorationOffer,
    ExplorationShare,
    ExplorationState,
    ExplorationStatus,
)
from explorer.options import number_of
from explorer.report import Report
from explorer.statement import Stage
from explorer.status import Picture, Status
from mr_grid import GridError, Pose
from mr_grid.ros import grid_value

CLUSTER_CELL = 0.5
MOST_UNITS = 1000  # larger numbers of a unit are no units

# Points of another robot's frame, in metres, whose images tell the whole transform.
PROBES = ((0.0, 0.0), (10.0, 0.0), (0.0, 10.0))


def map_from(message: OccupancyGrid) -> OccupancyMap:
    """Raises `MapError` for a grid that cannot be used. With `numpy_msg` the data are not copied."""
    rotation = message.info.origin.orientation
    if abs(rotation.x) > 1e-3 or abs(rotation.y) > 1e-3 or abs(rotation.z) > 1e-3:
        raise MapError("map origin is rotated; publish the map with an unrotated origin")
    try:
        grid = grid_value(message)
        place = Pose(grid.origin.x, grid.origin.y)
        return OccupancyMap(replace(grid.info, origin=place), grid.cells)
    except GridError as error:
        raise MapError(str(error)) from error


def pose_from(transform: Any) -> Pose:
    """From a geometry_msgs/TransformStamped map -> robot."""
    place, rotation = transform.transform.translation, transform.transform.rotation
    yaw = 2.0 * math.atan2(rotation.z, rotation.w)
    return Pose(place.x, place.y, math.atan2(math.sin(yaw), math.cos(yaw)))


def positions_from(message: MmListOfPoints) -> Dict[str, Tuple[float, float]]:
    return {point.src_robot.strip("/"): (point.x, point.y) for point in message.positions}


def named_point(robot: str, point: Tuple[float, float]) -> MmPoint:
    """A point in metres in the map frame of a robot."""
    return MmPoint(src_robot=robot, x=point[0], y=point[1])


@dataclass(frozen=True)
class Wire:
    """Frontiers and auctions to and from messages, by the identity rules of simulation and real robots.

    The name of the detecting robot always goes along. Only where it is missing in simulation, as in messages of the
    original, does the number count: it is ambiguous once a robot has used up its block of 10000.
    """

    simulation: bool

    def radio_call(self, effect: Union[SendFrontiers, SendAuction]) -> Tuple[str, str, Any]:
        """Service of adhoc_communication, topic at the others, and message."""
        if isinstance(effect, SendFrontiers):
            return "send_frontier", effect.topic, self.frontier_to(effect.elements)
        return "send_auction", "auction", self.auction_to(effect.auction)

    def elements_from(self, message: ExpFrontier) -> Tuple[Element, ...]:
        elements = []
        for element in message.frontier_element:
            robot = element.detected_by_robot_str.strip("/")
            if not robot and self.simulation:
                robot = f"robot_{element.detected_by_robot}"
            elements.append(Element(robot, int(element.id), element.x_coordinate, element.y_coordinate))
        return tuple(elements)

    def frontier_to(self, elements: Iterable[Element]) -> ExpFrontier:
        message = ExpFrontier()
        for element in elements:
            out = ExpFrontierElement(id=element.number, x_coordinate=element.x, y_coordinate=element.y)
            out.detected_by_robot_str = element.detected_by
            if self.simulation:
                out.detected_by_robot = number_of(element.detected_by)
            message.frontier_element.append(out)
        return message

    def auction_from(self, message: ExpAuction) -> Auction:
        robot = message.robot_name.strip("/")
        unit = _unit_in(message)
        return Auction(
            robot=f"robot_{robot}" if self.simulation and robot.isdigit() else robot,
            auction_id=int(message.auction_id),
            status=bool(message.auction_status_message),
            start=bool(message.start_auction),
            finished=bool(message.auction_finished),
            occupied=tuple(self._key_from(element) for element in message.occupied_ids),
            requested=tuple(self._bid_from(cluster) for cluster in message.requested_clusters if cluster is not unit),
            available=tuple(self._bid_from(cluster) for cluster in message.available_clusters if cluster is not unit),
            unit=PAPER_UNIT if unit is None else int(unit.bid),
        )

    def auction_to(self, auction: Auction) -> ExpAuction:
        message = ExpAuction(
            auction_status_message=auction.status,
            start_auction=auction.start,
            auction_finished=auction.finished,
            occupied_ids=[
                ExpAuctionElement(id=number, detected_by_robot_str=robot) for robot, number in auction.occupied
            ],
            requested_clusters=[self._bid_to(bid) for bid in auction.requested],
            auction_id=auction.auction_id,
            robot_name=str(number_of(auction.robot)) if self.simulation else auction.robot,
            available_clusters=[self._bid_to(bid) for bid in auction.available],
        )
        if auction.unit != PAPER_UNIT:
            _unread(message).append(ExpCluster(bid=float(auction.unit)))
        return message

    def _key_from(self, element: Any) -> Key:
        robot = element.detected_by_robot_str.strip("/")
        if not robot and self.simulation:
            robot = f"robot_{element.id // 10000}"
        return (robot, int(element.id))

    def _bid_from(self, cluster: ExpCluster) -> Bid:
        bid = float(cluster.bid) if math.isfinite(cluster.bid) else -1.0
        return Bid(tuple(self._key_from(element) for element in cluster.ids_contained), bid)

    def _bid_to(self, bid: Bid) -> ExpCluster:
        elements = [ExpClusterElement(id=number, detected_by_robot_str=robot) for robot, number in bid.elements]
        return ExpCluster(elements, bid.bid)


def _unread(message: ExpAuction) -> List[ExpCluster]:
    """The list of clusters that nobody reads in a message of this kind: offers in a reply, bids in a start."""
    return message.available_clusters if message.auction_status_message else message.requested_clusters


def _unit_in(message: ExpAuction) -> Optional[ExpCluster]:
    """The entry that tells the unit of the bids: one without elements in the list that is not read. None without."""
    entry = next((cluster for cluster in _unread(message) if not cluster.ids_contained), None)
    return entry if entry is not None and abs(entry.bid) <= MOST_UNITS else None


def goal_to(pose: Pose, frame: str, stamp: rospy.Time) -> MoveBaseGoal:
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = frame
    goal.target_pose.header.stamp = stamp
    goal.target_pose.pose.position = Point(pose.x, pose.y, 0.0)
    goal.target_pose.pose.orientation = Quaternion(0.0, 0.0, math.sin(pose.yaw / 2), math.cos(pose.yaw / 2))
    return goal


def point_to(x: float, y: float, frame: str, stamp: rospy.Time) -> PointStamped:
    message = PointStamped()
    message.header.frame_id, message.header.stamp = frame, stamp
    message.point = Point(x, y, 0.0)
    return message


def state_to(status: Status) -> ExplorationState:
    goal = status.goal
    return ExplorationState(
        robot_name=status.robot,
        state=int(status.state),
        text=status.text,
        exploration_finished=status.finished,
        exploration_time=status.exploration_time,
        has_goal=goal is not None,
        goal=Point(goal.x, goal.y, 0.0) if goal is not None else Point(),
        frontiers=status.frontiers,
        clusters=status.clusters,
        unreachable=status.unreachable,
        goals=status.counters.goals,
        goals_reached=status.counters.goals_reached,
        goals_failed=status.counters.goals_failed,
        auctions_completed=status.counters.auctions_completed,
        auctions_uncompleted=status.counters.auctions_uncompleted,
    )


def status_to(report: Report, frame: str) -> ExplorationStatus:
    """Without a stamp, so that equal messages are equal; the rest of the time in whole seconds."""
    status = report.status
    message = ExplorationStatus(
        robot_name=status.robot,
        state=int(status.state),
        text=status.text,
        paused=report.paused,
        ended_by=report.ended_by,
        has_goal=status.goal is not None,
        goal=Point(status.goal.x, status.goal.y, 0.0) if status.goal is not None else Point(),
        goal_reason=report.reason,
        strategy=report.strategy,
        bids=[ExplorationBid(robot, bid) for robot, bid in report.bids.items()],
        bid_unit=report.unit,
        auction_id=0 if report.auction is None else report.auction.auction_id,
        auction=[] if report.auction is None else [_offer_to(offer) for offer in report.auction.offers],
        assignment=[ExplorationShare(robot, Point(x, y, 0.0)) for robot, (x, y) in report.assignment.items()],
        area_known=report.area,
        expected_rest=math.nan if math.isnan(report.rest) else round(report.rest),
        left=[
            ExplorationLeftover(Point(*left.place, 0.0), left.points, left.size, left.reason) for left in report.left
        ],
        team=list(report.team),
        team_finished=[robot for robot, stage in report.team.items() if stage in (Stage.ENDED, Stage.QUIT)],
        team_nothing_left=[robot for robot, stage in report.team.items() if stage == Stage.NOTHING_LEFT],
        time_limit=report.limits.time,
        distance_limit=report.limits.distance,
        distance=round(status.counters.distance),
    )
    message.header.frame_id = frame
    return message


def _offer_to(offer: Offer) -> ExplorationOffer:
    bids = [ExplorationBid(robot, bid) for robot, bid in offer.bids.items()]
    return ExplorationOffer(Point(*offer.place, 0.0), bids, offer.explored_by)


def cluster_grids(picture: Picture, count: int, frame: str, stamp: rospy.Time) -> List[GridCells]:
    """Cells of 0.5 m at the members of the clusters, by cluster number modulo `count`; unused grids hold one cell
    far away (contract 3.2)."""
    grids = [GridCells(cell_width=CLUSTER_CELL, cell_height=CLUSTER_CELL) for _ in range(count)]
    for number, places in picture.clusters.items():
        grids[number % count].cells += [Point(x, y, 0.0) for x, y in places]
    for grid in grids:
        grid.header.frame_id, grid.header.stamp = frame, stamp
        if not grid.cells:
            grid.cells = [Point(1000.0, 1000.0, 1000.0)]
    return grids


def transform_from(images: Sequence[Optional[Tuple[float, float]]]) -> Optional[np.ndarray]:
    """(2, 3) transform from what `transformPoint` made of `PROBES`; None if an answer is missing."""
    if any(image is None for image in images):
        return None
    return rigid_transform(np.array(PROBES), np.array(images, dtype=float))
