"""The move_base node: parameters, topics, tf and the action of the navigation engine."""

import socket
import sys
import threading
import traceback
from typing import Any, Dict, Optional, Union

import rospy
import tf2_ros
from adhoc_communication.msg import MmListOfPoints
from geometry_msgs.msg import PoseStamped, Twist
from move_base_msgs.msg import MoveBaseAction, MoveBaseActionGoal, MoveBaseResult
from nav_msgs.msg import OccupancyGrid, Path
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import LaserScan

from mr_grid import OccupancyGrid as OccupancyGridValue
from mr_grid import Pose
from mr_grid.map_frame import MapFrame, MapRuns, NewFrame
from mr_grid.ros_map_frame import FrameListener, run_of_map
from mr_grid.ros_node import init_node, warn_of_unknown_parameters
from mr_robot.navigation import ros_io
from mr_robot.navigation.action_server import LatestGoalServer
from mr_robot.navigation.dates import Dates
from mr_robot.navigation.engine import Navigator, Status
from mr_robot.navigation.options import NavigationError, NavigationOptions, Scan
from mr_robot.navigation.tf_poses import TfPoses
from mr_robot.parameter_names import DRIVERS, FRAMES, NAVIGATION
from mr_robot.platforms.engines import defaults_of
from mr_robot.ros_poses import ParameterError, frame_name, frame_parameters, topic_parameters, transform_pose

TOPICS = {"others": "all_positions", "plan": "~plan"}
MAP_TOPIC = "map_merger/global_map"
OWN_MAP_TOPIC = "map"  # of this robot's SLAM
FEEDBACK_PERIOD = 0.5  # s


def options() -> NavigationOptions:
    values: Dict[str, Union[float, bool]] = {}
    for name, usual in defaults_of(NavigationOptions).items():
        value = rospy.get_param("~" + name, usual)
        wanted = bool if isinstance(usual, bool) else float
        if isinstance(value, bool) != (wanted is bool) or not isinstance(value, (int, float)):
            raise NavigationError(f"parameter ~{name} must be a {wanted.__name__}, not {value!r}")
        values[name] = wanted(value)
    return NavigationOptions(**values)  # type: ignore[arg-type]


def robot_name() -> str:
    """Parameter ~robot_name, else robot_name of a parent namespace, else the namespace, else the computer's name."""
    found = rospy.search_param("robot_name")
    return str(rospy.get_param(found)) if found else rospy.get_namespace().strip("/") or socket.gethostname()


class MoveBaseNode:
    def __init__(self) -> None:
        self._navigator = Navigator(options(), robot_name())
        self._frames = frame_parameters(FRAMES)
        topics = topic_parameters({**DRIVERS, "map_topic": MAP_TOPIC})
        self._lock = threading.RLock()
        self._runs = MapRuns()
        self._unnamed: Optional[OccupancyGridValue] = None  # the map, where it does not say whose frame it is in
        self._scan: Optional[Any] = None
        self._planned_at = self._fed_back_at = -float("inf")
        self._moving = False
        self._buffer = tf2_ros.Buffer(rospy.Duration(10.0))
        frame = MapFrame(self._frames["map_frame"], self._frames["base_frame"])
        self._listener = FrameListener(self._buffer, frame, self._on_new_frame)
        self._dates = Dates(self._navigator.options.controller_period)
        self._tf_poses = TfPoses(self._buffer, self._frames, self._dates)
        self._command = rospy.Publisher(topics["velocity_topic"], Twist, queue_size=1)
        self._plan = rospy.Publisher(TOPICS["plan"], Path, queue_size=1, latch=True)
        self._server = LatestGoalServer("move_base", MoveBaseAction, auto_start=False)
        self._goals = rospy.Publisher("move_base/goal", MoveBaseActionGoal, queue_size=1)
        rospy.Subscriber("move_base_simple/goal", PoseStamped, self._on_simple_goal, queue_size=1)
        rospy.Subscriber(topics["map_topic"], numpy_msg(OccupancyGrid), self._on_map, queue_size=1, buff_size=2**24)
        rospy.Subscriber(OWN_MAP_TOPIC, numpy_msg(OccupancyGrid), self._on_own_map, queue_size=1, buff_size=2**24)
        rospy.Subscriber(TOPICS["others"], MmListOfPoints, self._on_others, queue_size=1)
        rospy.Subscriber(topics["scan_topic"], numpy_msg(LaserScan), self._on_scan, queue_size=1)
        self._server.start()
        period = rospy.Duration(self._navigator.options.controller_period)
        self._timer = rospy.Timer(period, self._on_timer, reset=True)
        rospy.on_shutdown(self._stop)

    # --- inputs -------------------------------------------------------------------------------------------------------

    def _on_map(self, message: Any) -> None:
        self._look_at_frame("map", message)
        try:
            with self._lock:
                run = run_of_map(message)
                if self._runs.take(run, message.header.stamp.to_sec()):
                    grid = ros_io.grid_value(message)
                    self._navigator.set_map(grid)
                    self._unnamed = grid if run is None else None
        except NavigationError as error:
            rospy.logwarn_throttle(10.0, f"map ignored: {error}")

    def _on_own_map(self, message: Any) -> None:
        self._look_at_frame("own map", message)
        try:
            with self._lock:
                self._navigator.set_own_map(ros_io.grid_value(message), rospy.get_time())
        except NavigationError as error:
            rospy.logwarn_throttle(10.0, f"own map ignored: {error}")

    def _on_new_frame(self, new: NewFrame) -> None:
        """What the robot knows is in the former frame. A map of nobody's run may be that of a building, which holds."""
        with self._lock:
            self._runs.begin(new.until)
            self._navigator = Navigator(self._navigator.options, self._navigator.name)
            if self._unnamed is not None:
                self._navigator.set_map(self._unnamed)
            self._give_up("whoever tells where the robot is was started anew: the goal was in the frame of before")

    def _look_at_frame(self, what: str, message: Any) -> None:
        frame = frame_name(message.header.frame_id)
        if frame and frame != self._frames["map_frame"]:
            rospy.logwarn_throttle(
                60.0,
                f"{what} is in frame {frame}, and is taken as in {self._frames['map_frame']}: is ~map_frame right?",
            )

    def _on_scan(self, message: Any) -> None:
        self._scan = message

    def _on_others(self, message: MmListOfPoints) -> None:
        positions = {point.src_robot: (point.x, point.y) for point in message.positions}
        with self._lock:
            ignored = self._navigator.set_others(positions, rospy.get_time())
        if ignored:
            rospy.logwarn_throttle(
                60.0, f"{TOPICS['others']}: positions of {', '.join(ignored[:5])} cannot be, ignored"
            )

    def _on_simple_goal(self, message: PoseStamped) -> None:
        goal = MoveBaseActionGoal()
        goal.header.stamp = rospy.Time.now()
        goal.goal.target_pose = message
        self._goals.publish(goal)

    def _take_requests(self) -> None:
        """New goals and cancellations. Asked for in each control period: the server's callbacks run under its own lock,
        so they must not wait for this node's lock, which is held while the server is called."""
        if self._server.is_new_goal_available():
            self._take_goal(self._server.accept_new_goal())
        elif self._server.is_preempt_requested() and self._server.is_active():
            self._navigator.cancel()
            self._server.set_preempted(MoveBaseResult(), "goal was cancelled")

    def _take_goal(self, goal: Any) -> None:
        if goal is None:
            return
        try:
            self._navigator.set_goal(self._in_map(goal.target_pose), rospy.get_time())
            self._planned_at = -float("inf")
        except NavigationError as error:
            self._navigator.cancel()
            self._server.set_aborted(MoveBaseResult(), str(error))

    def _in_map(self, target: PoseStamped) -> Pose:
        goal = ros_io.goal_value(target)
        frame = frame_name(target.header.frame_id)
        if frame == self._frames["map_frame"]:
            return goal
        if not frame:
            raise NavigationError("goal names no frame: set target_pose.header.frame_id")
        try:
            message = self._buffer.lookup_transform(self._frames["map_frame"], frame, rospy.Time(0))
        except tf2_ros.TransformException as error:
            raise NavigationError(
                f"goal is given in frame {frame}, which has no transform to the map: {error}"
            ) from None
        return transform_pose(message).compose(goal)

    # --- control ------------------------------------------------------------------------------------------------------

    def _on_timer(self, _: rospy.timer.TimerEvent) -> None:
        self._dates.step(rospy.get_time())
        with self._lock:
            try:
                self._take_requests()
                if self._server.is_active() or self._moving:
                    self._control(rospy.get_time())
            except Exception as error:
                # It would end the timer's thread, and with it all control of a robot that may be driving.
                rospy.logerr(f"navigation failed, the robot stops: {traceback.format_exc()}")
                self._give_up(f"navigation failed: {error}")

    def _give_up(self, reason: str) -> None:
        self._stop()
        self._moving = False
        self._navigator.cancel()
        if self._server.is_active():
            self._server.set_aborted(MoveBaseResult(), reason)

    def _control(self, now: float) -> None:
        located = self._tf_poses.robot(now)
        pose, scan = (located[0], self._scan_value(now, located[1])) if located else (None, None)
        command = self._navigator.step(now, pose, scan)
        twist = Twist()
        twist.linear.x, twist.angular.z = command.linear, command.angular
        self._command.publish(twist)
        self._moving = command.linear != 0.0 or command.angular != 0.0
        if not self._server.is_active():
            return
        if command.status is Status.SUCCEEDED:
            self._server.set_succeeded(MoveBaseResult(), "goal reached")
        elif command.status is Status.ABORTED:
            rospy.logwarn(command.text)
            self._server.set_aborted(MoveBaseResult(), command.text)
        elif located is not None:
            self._report(now, *located)

    def _report(self, now: float, pose: Pose, stamp: rospy.Time) -> None:
        """`stamp`: of the pose, which is older than `now`: a robot that turns is elsewhere by then."""
        frame = self._frames["map_frame"]
        if not 0.0 <= now - self._fed_back_at < FEEDBACK_PERIOD:
            self._fed_back_at = now
            self._server.publish_feedback(ros_io.feedback_message(pose, frame, stamp))
        if self._plan.get_num_connections() and not 0.0 <= now - self._planned_at < self._navigator.options.plan_period:
            self._planned_at = now
            self._plan.publish(ros_io.path_message(self._navigator.path(pose), frame, stamp))

    def _scan_value(self, now: float, stamp: rospy.Time) -> Optional[Scan]:
        """The latest scan as seen from where the robot was at `stamp`."""
        message = self._scan
        if message is None or not self._tf_poses.is_recent("scan", message.header.stamp, now):
            return None
        mount = self._tf_poses.laser(message.header.frame_id, message.header.stamp, stamp)
        try:
            return None if mount is None else ros_io.scan_value(message, mount)
        except NavigationError as error:
            rospy.logwarn_throttle(10.0, f"scan ignored: {error}")
            return None

    def _stop(self) -> None:
        self._command.publish(Twist())


def main() -> int:
    init_node("move_base")
    try:
        MoveBaseNode()
    except (NavigationError, ParameterError) as error:
        rospy.logfatal(str(error))
        return 1
    warn_of_unknown_parameters(NAVIGATION)
    rospy.spin()
    return 0


if __name__ == "__main__":
    sys.exit(main())
