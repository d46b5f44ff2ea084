"""Gathers what the page of one robot shows from the robot's own ROS master. The topics are listed in `RobotFeed`."""

from __future__ import annotations

import re
import threading
from typing import Any, Callable

import numpy as np
import rosgraph
import rospy
import tf2_ros
from adhoc_communication.msg import MmListOfPoints, NetworkState
from explorer.msg import ExplorationState, ExplorationStatus, TeamOverview
from explorer.srv import OrderRobots, SetLimits
from map_merger.msg import MergerStatus
from map_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import GridCells, OccupancyGrid, Path
from rosgraph_msgs.msg import Log
from rospy.numpy_msg import numpy_msg
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

from mr_grid import GridError, Pose
from mr_grid.ros import grid_value, yaw_of
from mr_page.commands import LIMITS_SERVICE, ORDER_SERVICE, PASS_ON, SERVICES, TEAM_LIMITS_SERVICE, Answer, Order
from mr_page.ros_values import (
    LEVELS,
    decision_values,
    exploration_values,
    merger_values,
    network_values,
    team_values,
)
from mr_page.service_calls import ServiceCalls
from mr_page.state import PageState
from mr_page.watch import RobotWatch

CLUSTER_GRIDS = 20
NOWHERE = 900.0  # m; grids of clusters that are not used have a cell beyond
LARGE = 1 << 24  # octets; receive buffer for maps
SERVICES_PERIOD = 3.0  # s between two looks at which services there are

Handler = Callable[..., None]


class RobotFeed:
    """Subscribes to all topics of one robot and keeps a PageState of it up to date. `lock` guards the state.

    Args:
        start: true pose of its map frame in the world; None where that is not known.
        base: it is a base station without a body.
        map_frame, base_frame: of the robot.
    """

    def __init__(self, robot: str, start: Pose | None, base: bool, map_frame: str, base_frame: str) -> None:
        self.state = PageState()
        self.lock = threading.Lock()
        self._robot = robot
        self._watch = RobotWatch(self.state, robot)
        self._watch.about(start=None if start is None else [round(value, 4) for value in start], base=base)
        self._map_frame = map_frame
        self._base_frame = base_frame
        self._has_body = not base
        self._services_at = -SERVICES_PERIOD
        self._calls = ServiceCalls()
        self._tf = tf2_ros.Buffer(rospy.Duration(5.0))
        self._listener = tf2_ros.TransformListener(self._tf) if self._has_body else None
        self._subscribe("map", numpy_msg(OccupancyGrid), self._on_map, "local")
        self._subscribe("map_merger/global_map", numpy_msg(OccupancyGrid), self._on_map, "global")
        self._subscribe("map_merger/global_map_updates", numpy_msg(OccupancyGridUpdate), self._on_patch, "global")
        self._subscribe("map_merger/status", MergerStatus, self._on_merger)
        self._subscribe("all_positions", MmListOfPoints, self._on_positions)
        self._subscribe("explorer/state", ExplorationState, self._on_exploration)
        self._subscribe("explorer/status", ExplorationStatus, self._on_decision)
        self._subscribe("frontierPoints", MarkerArray, self._on_frontiers)
        for index in range(CLUSTER_GRIDS):
            self._subscribe(f"cluster_grid_{index}", GridCells, self._on_cluster, index)
        self._subscribe("move_base/plan", Path, self._on_plan)
        self._subscribe("adhoc_communication/network_state", NetworkState, self._on_network)
        self._subscribe("mission_control/team", TeamOverview, self._on_team)
        self._subscribe("/rosout_agg", Log, self._on_log)

    def _subscribe(self, topic: str, kind: Any, handler: Handler, *more: Any) -> None:
        def guarded(message: Any) -> None:
            with self.lock:
                handler(message, *more)

        large = {"buff_size": LARGE} if kind._type.startswith(("nav_msgs/Occ", "map_msgs")) else {}
        queue = 10 if kind in (Log,) or topic.endswith("_updates") else 1
        rospy.Subscriber(topic, kind, guarded, queue_size=queue, **large)

    def tick(self) -> None:
        """What no topic tells: the pose, the time, which services there are."""
        pose = self._pose()
        offered = self._offered()
        with self.lock:
            self._watch.time(rospy.get_time())
            if self._has_body:
                self._watch.pose(pose)
            if offered is not None:
                self._watch.services(offered)

    def command(self, order: Order) -> Answer:
        """Calls the service of a command; blocks for a few seconds at most."""
        if order.command not in SERVICES:
            return Answer(False, "only radios of simulated robots can be switched from the page of their team")
        service = SERVICES[order.command]
        answer = self._calls.answer(service, lambda: _answer(service, order))
        with self.lock:
            self._watch.answered(order.command, answer.done, answer.text, rospy.get_time())
        return answer

    def _pose(self) -> Pose | None:
        try:
            found = self._tf.lookup_transform(self._map_frame, self._base_frame, rospy.Time(0)).transform
        except tf2_ros.TransformException:
            return None
        return Pose(found.translation.x, found.translation.y, yaw_of(found.rotation))

    def _offered(self) -> dict[str, bool] | None:
        """Commands whose services are registered; None if it is too early to look again."""
        now = rospy.get_rostime().to_sec()
        if 0.0 <= now - self._services_at < SERVICES_PERIOD:
            return None
        self._services_at = now
        try:
            _, _, services = rosgraph.Master(rospy.get_name()).getSystemState()
        except (OSError, rosgraph.MasterException):
            return None
        known = {name for name, _ in services}
        return {command: rospy.resolve_name(service) in known for command, service in SERVICES.items()}

    def _on_map(self, message: Any, kind: str) -> None:
        try:
            grid = grid_value(message)
        except GridError as error:
            rospy.logwarn_throttle(60.0, f"page: the {kind} map cannot be shown: {error}")
            return
        self._watch.map(kind, grid)

    def _on_patch(self, message: Any, kind: str) -> None:
        cells = np.asarray(message.data, dtype=np.int8)
        if cells.size == message.width * message.height:
            self._watch.patch(kind, message.y, message.x, cells.reshape(message.height, message.width))

    def _on_merger(self, message: MergerStatus) -> None:
        self._watch.merger(merger_values(message), rospy.get_time())

    def _on_positions(self, message: MmListOfPoints) -> None:
        places = {point.src_robot.strip("/"): (point.x, point.y) for point in message.positions}
        self._watch.peers({name: place for name, place in places.items() if name != self._robot})

    def _on_exploration(self, message: ExplorationState) -> None:
        self._watch.exploration(exploration_values(message), rospy.get_time())

    def _on_decision(self, message: ExplorationStatus) -> None:
        self._watch.decision(decision_values(message), rospy.get_time())

    def _on_frontiers(self, message: MarkerArray) -> None:
        """Own ones come first."""
        if message.markers:
            self._watch.points("frontiers", [(point.x, point.y) for point in message.markers[0].points])

    def _on_cluster(self, message: GridCells, index: int) -> None:
        self._watch.cluster(index, [(cell.x, cell.y) for cell in message.cells if abs(cell.x) < NOWHERE])

    def _on_plan(self, message: Path) -> None:
        self._watch.points("plan", [(pose.pose.position.x, pose.pose.position.y) for pose in message.poses])

    def _on_network(self, message: NetworkState) -> None:
        self._watch.network(network_values(message), rospy.get_time())

    def _on_team(self, message: TeamOverview) -> None:
        self._watch.team(team_values(message), rospy.get_time())

    def _on_log(self, message: Log) -> None:
        if message.level in LEVELS:
            text = re.sub(r"\x1b\[[0-9;]*m", "", message.msg)
            self._watch.log(LEVELS[message.level], message.name, text, rospy.get_time())


def _answer(service: str, order: Order) -> Answer:
    try:
        rospy.wait_for_service(service, timeout=0.5)
        response = _called(service, order)
    except (rospy.ServiceException, rospy.ROSException) as error:
        return Answer(False, f"the service {service} does not answer: {error}")
    return Answer(response.success, response.message)


def _called(service: str, order: Order) -> Any:
    """The response of the service of an order. Raises rospy.ServiceException."""
    if service == ORDER_SERVICE:
        limits = order.limits or (0.0, 0.0)
        return rospy.ServiceProxy(service, OrderRobots)(order.command[len(PASS_ON) :], [order.to], *limits)
    if service in (LIMITS_SERVICE, TEAM_LIMITS_SERVICE):
        return rospy.ServiceProxy(service, SetLimits)(*order.limits)
    return rospy.ServiceProxy(service, Trigger)()
