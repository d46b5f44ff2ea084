"""ROS messages to and from the SLAM engine's values."""

import numpy as np
import rospy
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import LaserScan as LaserScanMessage

from mr_grid import IDENTITY, Pose
from mr_grid.ros import quaternion
from mr_grid.ros_laser import Mount
from mr_robot.slam.engine import LaserScan, SlamError

LONGEST_SWEEP = 0.5  # s from the first beam to the last one


def sweep_time(message: LaserScanMessage) -> float:
    """Seconds from the first beam to the last one. Raises SlamError for what no laser does."""
    seconds = max(0, len(message.ranges) - 1) * float(message.time_increment)
    if not 0.0 <= seconds <= LONGEST_SWEEP:
        raise SlamError(
            f"time_increment {message.time_increment:g} of the scan lets its {len(message.ranges)} beams take "
            f"{seconds:g} s, not 0 to {LONGEST_SWEEP:g} s: beams count as taken at once"
        )
    return seconds


def scan_value(message: LaserScanMessage, mount: Mount, swept: Pose = IDENTITY) -> LaserScan:
    """`swept`: robot at the last beam seen from where it was at the first."""
    return LaserScan(
        np.asarray(message.ranges, dtype=np.float32),
        *mount.beams(message),
        message.range_min,
        message.range_max,
        mount.pose,
        swept,
    )


def transform_message(pose: Pose, frame: str, child: str, stamp: rospy.Time) -> TransformStamped:
    message = TransformStamped()
    message.header.frame_id = frame
    message.header.stamp = stamp
    message.child_frame_id = child
    message.transform.translation.x, message.transform.translation.y = pose[0], pose[1]
    message.transform.rotation = quaternion(pose[2])
    return message
