"""Poses and scans of the own robot from ROS, brought into its map frame with tf2. Only the node uses this."""

from typing import Any, Callable, Optional, Tuple

import rospy
import tf2_ros
from nav_msgs.msg import Odometry
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import LaserScan as LaserScanMessage

from mr_grid import Pose

from . import ros_io
from .meetings.detection import LaserScan
from .timer import Timer
from .whereabouts import POSE_PERIOD_S

SCAN_PERIOD_S = 0.2
SCAN_PATIENCE_S = 0.3
"""A scan waits this long for the transforms of its time."""
QUIET_S = 5.0
"""For so long after the first trouble nothing is said of missing transforms: SLAM may just be starting."""


class PoseInput:
    """The robot's pose in its map frame from odometry, at most every POSE_PERIOD_S."""

    def __init__(self, topic: str, map_frame: str, buffer: tf2_ros.Buffer) -> None:
        self._map_frame, self._buffer = map_frame.lstrip("/"), buffer
        self._timer = Timer(POSE_PERIOD_S)
        self._trouble = Timer(30.0, first=QUIET_S)
        self._latest: Optional[Any] = None
        self.base_frame = ""
        """Frame of the robot's body, as the odometry names it; empty until there is some."""
        # Kept as bytes: of twenty messages a second one or two are looked at.
        rospy.Subscriber(topic, rospy.AnyMsg, self._keep, queue_size=1)

    def _keep(self, message: Any) -> None:
        self._latest = message

    def take(self) -> Optional[Tuple[Pose, float]]:
        """The newest pose and its stamp in s; None if there is no new one or it cannot be used, which is reported once
        in a while."""
        if self._latest is None or not self._timer.fires(rospy.get_time()):
            return None
        raw, self._latest = self._latest, None
        try:
            odometry = Odometry().deserialize(raw._buff)
            self.base_frame = odometry.child_frame_id.lstrip("/")
            pose = ros_io.transform_of_pose(odometry.pose.pose)
            frame = odometry.header.frame_id.lstrip("/")
            stamp = odometry.header.stamp.to_sec()
            return (pose if frame == self._map_frame else self._to_map(frame).compose(pose)), stamp
        except tf2_ros.TransformException as error:
            if self._trouble.fires(rospy.get_time()):
                rospy.logwarn(f"map_merger does not know its position yet: {error}")
        except Exception as error:
            rospy.logwarn_throttle(30.0, f"map_merger ignored odometry: {error}")
        return None

    def _to_map(self, frame: str) -> Pose:
        return ros_io.transform_of_message(self._buffer.lookup_transform(self._map_frame, frame, rospy.Time(0)))


class ScanInput:
    """Scans with the pose of the robot at their time, at most every SCAN_PERIOD_S and only while they are wanted."""

    def __init__(
        self,
        topic: str,
        map_frame: str,
        buffer: tf2_ros.Buffer,
        base_frame: Callable[[], str],
        wanted: Callable[[], bool],
        take: Callable[[LaserScan, Pose, float], None],
    ) -> None:
        """`take` is called in the subscriber's thread with a scan, the robot's pose in its map frame at its
        time, and its stamp in s."""
        self._map_frame, self._buffer = map_frame.lstrip("/"), buffer
        self._base_frame, self._wanted, self._take = base_frame, wanted, take
        self._timer = Timer(SCAN_PERIOD_S)
        self._trouble = Timer(30.0, first=QUIET_S)
        rospy.Subscriber(topic, rospy.AnyMsg, self._on_scan, queue_size=1, buff_size=2**20)

    def _on_scan(self, raw: Any) -> None:
        if not self._wanted() or not self._timer.fires(rospy.get_time()):
            return
        try:
            message = numpy_msg(LaserScanMessage)().deserialize(raw._buff)
            sensor_frame = message.header.frame_id.lstrip("/")
            base_frame = self._base_frame() or sensor_frame
            patience = rospy.Duration.from_sec(SCAN_PATIENCE_S)
            pose = self._buffer.lookup_transform(self._map_frame, base_frame, message.header.stamp, patience)
            mount = self._buffer.lookup_transform(base_frame, sensor_frame, rospy.Time(0))
            scan = ros_io.scan_of(message, ros_io.mount_of(mount))
            robot = ros_io.transform_of_message(pose)
        except tf2_ros.TransformException as error:
            if self._trouble.fires(rospy.get_time()):
                rospy.logwarn(f"map_merger cannot place its scans yet: {error}")
            return
        except Exception as error:
            rospy.logwarn_throttle(30.0, f"map_merger ignored a scan: {error}")
            return
        self._take(scan, robot, message.header.stamp.to_sec())
