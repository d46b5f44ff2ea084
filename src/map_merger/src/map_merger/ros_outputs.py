"""What the node tells people and programs, as ROS messages, publishers and services. Nothing here decides."""

from typing import Callable, Iterable, List, Optional, Tuple

import numpy as np
import rospy
from geometry_msgs.msg import Point
from map_msgs.msg import OccupancyGridUpdate
from rospy.numpy_msg import numpy_msg
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from map_merger.msg import MergerStatus, RobotPlacement
from map_merger.srv import ForgetRobot, ForgetRobotResponse, SaveMap, SaveMapResponse
from mr_grid import OccupancyGrid, Pose
from mr_grid.map_files import MapFileError, save_map
from mr_grid.ros import pose_message

from . import status
from .grid import Box, full_box
from .markers import RobotMarker, colour_of

NumpyGridUpdate = numpy_msg(OccupancyGridUpdate)

TRANSFORM_AHEAD_S = 1.0
"""Transforms are dated so far ahead that there is always one for "now": twice their period. So a lookup sees a change,
and the end of a revoked one, at most so much later."""
MARKER_LIFETIME_S = 10.0
"""Markers that are not renewed vanish: a robot that was forgotten needs no message that deletes its own."""
POSITION, NAME, OUTLINE = range(3)
"""Identifiers of a robot's markers; the namespace is its name."""


class Outputs:
    """Publishers of the node beside those of the contract. `frame`: the own map frame."""

    def __init__(self, frame: str) -> None:
        self._frame = frame
        self._status = rospy.Publisher("~status", MergerStatus, queue_size=3, latch=True)
        self._markers = rospy.Publisher("~markers", MarkerArray, queue_size=3)
        self._updates = rospy.Publisher("~global_map_updates", NumpyGridUpdate, queue_size=10)

    def show_status(self, state: status.MergerStatus, stamp: rospy.Time) -> None:
        """The state of the merging."""
        self._status.publish(status_message(state, self._frame, stamp))

    def show_team(self, robots: Callable[[], Iterable[RobotMarker]], stamp: rospy.Time) -> None:
        """The team's markers, which are asked for only while somebody looks."""
        if self._markers.get_num_connections():
            self._markers.publish(team_markers(robots(), self._frame, stamp))

    def show_update(self, grid: OccupancyGrid, box: Box, stamp: rospy.Time) -> None:
        """The part of the global map that changed; its size is that of the last whole one."""
        if self._updates.get_num_connections() and not box.empty:
            self._updates.publish(update_message(grid, box, self._frame, stamp))


def serve(
    global_map: Callable[[], Optional[OccupancyGrid]], forget: Callable[[str], None]
) -> Tuple[rospy.Service, ...]:
    """The services beside those of the contract. forget: raises KeyError for a robot that is not known."""

    def on_save(request: SaveMap) -> SaveMapResponse:
        try:
            return SaveMapResponse(*save_map(request.path, global_map()))
        except MapFileError as error:
            raise rospy.ServiceException(str(error)) from error

    def on_forget(request: ForgetRobot) -> ForgetRobotResponse:
        try:
            forget(request.robot)
        except KeyError as error:
            raise rospy.ServiceException(f"nothing is known of a robot {request.robot!r}") from error
        return ForgetRobotResponse()

    return rospy.Service("~saveMap", SaveMap, on_save), rospy.Service("~forgetRobot", ForgetRobot, on_forget)


def dated_ahead(stamp: rospy.Time) -> rospy.Time:
    """Stamp for a transform that is broadcast at `stamp`."""
    return stamp + rospy.Duration(TRANSFORM_AHEAD_S)


def update_message(grid: OccupancyGrid, box: Box, frame: str, stamp: rospy.Time) -> OccupancyGridUpdate:
    """The cells of `box`, which must be inside the grid, for a numpy publisher."""
    if box.empty or not full_box(grid.info).contains(box):
        raise ValueError(f"{box} is not a part of a map of {grid.info.shape} cells")
    rows, columns = box.shape
    message = NumpyGridUpdate(x=box.left, y=box.top, width=columns, height=rows)
    message.header.frame_id, message.header.stamp = frame, stamp
    message.data = np.ascontiguousarray(grid.cells[box.slices()], dtype=np.int8).ravel()
    return message


def status_message(state: status.MergerStatus, frame: str, stamp: rospy.Time) -> MergerStatus:
    """The state of the merging, robots by name."""
    robots = [placement_message(each) for each in sorted(state.robots, key=lambda each: each.robot)]
    message = MergerStatus(robot=state.robot, topology=state.topology, base_station=state.base_station, robots=robots)
    message.wants_to_meet = sorted(state.wants_to_meet)
    message.text = status.summary_of(state)
    message.header.frame_id, message.header.stamp = frame, stamp
    return message


def placement_message(placement: status.RobotPlacement) -> RobotPlacement:
    """One robot of the status."""
    x, y, yaw = placement.transform or Pose()
    return RobotPlacement(
        robot=placement.robot,
        placed=placement.placed,
        why=placement.why,
        via=placement.via,
        x=x,
        y=y,
        yaw=yaw,
        covariance=[value for row in placement.covariance for value in row],
        confidence=placement.confidence,
        shared_wall_m=placement.shared_wall,
        age_s=placement.age,
        bytes_received=placement.bytes_received,
    )


def team_markers(robots: Iterable[RobotMarker], frame: str, stamp: rospy.Time) -> MarkerArray:
    """All robots: an arrow and the name where each is, and a line around what its map knows."""
    markers: List[Marker] = []
    for robot in robots:
        if robot.pose is not None:
            markers += [_arrow(robot, robot.pose), _name(robot, robot.pose)]
        if len(robot.outline):
            markers.append(_outline(robot))
    for marker in markers:
        marker.header.frame_id, marker.header.stamp = frame, stamp
    return MarkerArray(markers)


def _marker(robot: RobotMarker, identifier: int, kind: int, at: Pose) -> Marker:
    red, green, blue = colour_of(robot.robot)
    return Marker(
        ns=robot.robot,
        id=identifier,
        type=kind,
        action=Marker.ADD,
        pose=pose_message(at),
        color=ColorRGBA(red, green, blue, 1.0),
        lifetime=rospy.Duration(MARKER_LIFETIME_S),
    )


def _arrow(robot: RobotMarker, pose: Pose) -> Marker:
    marker = _marker(robot, POSITION, Marker.ARROW, pose)
    marker.scale.x, marker.scale.y, marker.scale.z = 0.6, 0.15, 0.15
    return marker


def _name(robot: RobotMarker, pose: Pose) -> Marker:
    marker = _marker(robot, NAME, Marker.TEXT_VIEW_FACING, Pose(pose.x, pose.y))
    marker.pose.position.z, marker.scale.z, marker.text = 0.5, 0.4, robot.robot
    return marker


def _outline(robot: RobotMarker) -> Marker:
    marker = _marker(robot, OUTLINE, Marker.LINE_STRIP, Pose())
    marker.scale.x = 0.05
    marker.points = [Point(x, y, 0.0) for x, y in [*robot.outline.tolist(), robot.outline[0].tolist()]]
    return marker
