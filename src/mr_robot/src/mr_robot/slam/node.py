"""The slam node: parameters, topics and tf of the SLAM engine."""

import sys
import threading
from collections import deque
from typing import Any, Callable, Deque, Dict, Optional, TypeVar

import rospy
import tf2_ros
from nav_msgs.msg import MapMetaData, Odometry
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import LaserScan

from mr_grid import GridError, Pose
from mr_grid.ros import NumpyOccupancyGrid, grid_message, yaw_of
from mr_grid.ros_laser import Mount, mount_value
from mr_grid.ros_node import init_node, until_shutdown, warn_of_unknown_parameters
from mr_robot.parameter_names import FRAMES, SLAM, SLAM_INPUTS
from mr_robot.platforms.engines import defaults_of
from mr_robot.ros_poses import ParameterError, frame_name, frame_parameters, topic_parameters
from mr_robot.slam import ros_io
from mr_robot.slam.engine import MAP_UPDATE_INTERVAL, OdometryHistory, Slam, SlamError, SlamOptions
from mr_robot.slam.keeper import MapKeeper

T = TypeVar("T")

TOPICS = {"map": "map", "metadata": "map_metadata"}
TRANSFORM_PUBLISH_PERIOD = 0.1  # s
MOUNT_PATIENCE = 5.0  # s in which the drivers may begin to tell where the laser is
TRANSFORM_TOLERANCE = 0.2  # s by which map -> odom is dated ahead
MOST_WAITING = 40  # scans, a second of a fast laser
GREATEST = 1.0e6  # of a parameter, whatever its unit: more is a mistake, and no time of ROS
CLOCKS_APART = 0.5  # s between a scan and the newest odometry, from which on they seem to have two clocks


def number_parameter(name: str, default: float, least: float = 0.0) -> float:
    value = rospy.get_param("~" + name, default)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not least <= value <= GREATEST:
        raise SlamError(f"parameter ~{name} must be a number from {least:g} to {GREATEST:g}, not {value!r}")
    return float(value)


def options() -> SlamOptions:
    return SlamOptions(**{name: number_parameter(name, usual) for name, usual in defaults_of(SlamOptions).items()})


class SlamNode:
    def __init__(self) -> None:
        self._slam = Slam(options())
        self._frames = frame_parameters(FRAMES)
        inputs = topic_parameters(SLAM_INPUTS)
        self._map_interval = number_parameter("map_update_interval", MAP_UPDATE_INTERVAL)
        self._transform_period = number_parameter("transform_publish_period", TRANSFORM_PUBLISH_PERIOD)
        self._tolerance = rospy.Duration(number_parameter("transform_tolerance", TRANSFORM_TOLERANCE))
        self._lock = threading.Lock()
        self._odometry = OdometryHistory()
        self._keeper = MapKeeper(self._slam, self._odometry)
        self._waiting: Deque[Any] = deque(maxlen=MOST_WAITING)  # scans, for odometry to catch up
        self._mounts: Dict[str, Mount] = {}
        self._published_revision = 0
        self._published_at = -float("inf")
        self._transformed_at = -float("inf")
        self._buffer = tf2_ros.Buffer()
        self._listener: Optional[tf2_ros.TransformListener] = None
        self._listens_since = 0.0
        self._broadcaster = tf2_ros.TransformBroadcaster()
        self._map = rospy.Publisher(TOPICS["map"], NumpyOccupancyGrid, queue_size=1, latch=True)
        self._metadata = rospy.Publisher(TOPICS["metadata"], MapMetaData, queue_size=1, latch=True)
        rospy.Subscriber(inputs["odometry_topic"], Odometry, self._guard(self._on_odometry), queue_size=20)
        rospy.Subscriber(inputs["scan_topic"], numpy_msg(LaserScan), self._guard(self._on_scan), queue_size=2)

    def _guard(self, handler: Callable[[T], None]) -> Callable[[T], None]:
        """One message at a time; a bad one is reported and dropped."""

        def guarded(message: T) -> None:
            try:
                with self._lock, until_shutdown():
                    handler(message)
            except (SlamError, GridError) as error:
                rospy.logwarn_throttle(10.0, f"message dropped: {error}")
            except (MemoryError, RuntimeError) as error:
                rospy.logerr_throttle(10.0, f"message dropped, SLAM failed: {error!r}")

        return guarded

    def _on_odometry(self, message: Odometry) -> None:
        pose = message.pose.pose
        stamp = message.header.stamp
        follows = self._odometry.add(stamp.to_sec(), Pose(pose.position.x, pose.position.y, yaw_of(pose.orientation)))
        if not follows:
            self._transformed_at = -float("inf")  # the last one no longer says where the robot is
            rospy.logwarn_throttle(
                10.0,
                f"odometry has jumped to ({pose.position.x:.1f}, {pose.position.y:.1f}), as of a driver that begins "
                "anew: the robot is taken not to have moved",
            )
        self._use_waiting()
        if self._slam.revision and not 0.0 <= stamp.to_sec() - self._transformed_at < self._transform_period - 0.01:
            self._publish_transform(stamp)

    def _on_scan(self, message: Any) -> None:
        if self._waiting and message.header.stamp < self._waiting[-1].header.stamp:
            self._waiting.clear()  # the clock was set back
        self._waiting.append(message)
        self._use_waiting()

    def _use_waiting(self) -> None:
        while self._waiting:
            message = self._waiting.popleft()
            if not self._use(message):
                self._waiting.appendleft(message)
                return

    def _use(self, message: Any) -> bool:
        """False if the odometry of its time is still to come."""
        mount = self._mount(message.header.frame_id)
        if mount is None:
            return True
        time = message.header.stamp.to_sec()
        last = time + self._sweep_time(message)
        newest = self._odometry.newest()
        if newest is not None and abs(last - newest[0]) > CLOCKS_APART:
            rospy.logwarn_throttle(
                10.0,
                f"scan is dated {last - newest[0]:+.1f} s off the newest odometry: the drivers of laser and wheels "
                "must have one clock, and both must run",
            )
        odometry, odometry_after = self._odometry.at(time), self._odometry.at(last)
        if odometry is None or odometry_after is None:
            # What is too old, or came before all odometry, is of no use any more.
            return newest is None or last <= newest[0]
        scan = ros_io.scan_value(message, mount, odometry.between(odometry_after))
        update = self._slam.process(scan, odometry, time)
        self._keeper.keep_map()
        if update.beyond:
            rospy.logwarn_once(
                f"the laser sees something {update.beyond:.0f} m away; from {self._slam.reach:g} m on that counts as "
                "nothing, so that the map stays small enough for all who read it: a larger ~resolution reaches farther"
            )
        if not update.matched:
            rospy.logwarn_throttle(10.0, f"scan does not match the map ({update.share:.0%} of it does)")
        if not 0.0 <= time - self._published_at < self._map_interval:
            self._publish_map(message.header.stamp)
        return True

    @staticmethod
    def _sweep_time(message: Any) -> float:
        try:
            return ros_io.sweep_time(message)
        except SlamError as error:
            rospy.logwarn_once(str(error))
            return 0.0

    def _mount(self, frame: str) -> Optional[Mount]:
        """The laser on the robot; looked up once, because listening to tf costs more than matching scans."""
        frame = frame_name(frame)
        if frame in self._mounts:
            return self._mounts[frame]
        if self._listener is None:
            self._listener = tf2_ros.TransformListener(self._buffer)
            self._listens_since = rospy.get_time()
        try:
            message = self._buffer.lookup_transform(self._frames["base_frame"], frame, rospy.Time(0))
            self._mounts[frame] = mount_value(message)
        except tf2_ros.TransformException as error:
            if rospy.get_time() - self._listens_since >= MOUNT_PATIENCE:
                what = f"no transform from {self._frames['base_frame']} to the laser yet"
                rospy.logwarn_throttle(10.0, f"{what}: {error}")
            return None
        except GridError as error:
            rospy.logwarn_throttle(10.0, f"scans are ignored: {error}")
            return None
        self._listener.unregister()
        self._listener = None
        return self._mounts[frame]

    def _publish_transform(self, stamp: rospy.Time) -> None:
        self._transformed_at = stamp.to_sec()
        self._keeper.keep_place()
        pose = self._slam.map_to_odometry().compose(self._odometry.offset)
        self._broadcaster.sendTransform(
            ros_io.transform_message(
                pose, self._frames["map_frame"], self._frames["odom_frame"], stamp + self._tolerance
            )
        )

    def _publish_map(self, stamp: rospy.Time) -> None:
        if self._slam.revision == self._published_revision:
            return
        self._published_revision = self._slam.revision
        self._published_at = stamp.to_sec()
        message = grid_message(self._slam.map(), self._frames["map_frame"], stamp)
        message.info.map_load_time = self._keeper.begun(stamp)
        self._map.publish(message)
        self._metadata.publish(message.info)


def main() -> int:
    init_node("slam")
    try:
        SlamNode()
    except (SlamError, ParameterError) as error:
        rospy.logfatal(str(error))
        return 1
    warn_of_unknown_parameters(SLAM)
    rospy.spin()
    return 0


if __name__ == "__main__":
    sys.exit(main())
