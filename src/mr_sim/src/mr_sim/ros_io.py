"""Messages of the robot node from what the world says. The only module of the world side that knows ROS types."""

from collections.abc import Sequence

import numpy as np
import rospy
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import LaserScan

from mr_grid.ros import quaternion
from mr_sim import protocol

# Serialised from the array's memory instead of a list of 541 Python floats.
ArrayLaserScan = numpy_msg(LaserScan)


def odometry_message(frame: str, child: str) -> Odometry:
    message = Odometry()
    message.header.frame_id = frame
    message.child_frame_id = child
    return message


def fill_odometry(message: Odometry, stamp: rospy.Time, pose: Sequence[float], twist: Sequence[float]) -> None:
    """`pose`: x, y, yaw; `twist`: linear x, linear y, angular z."""
    message.header.stamp = stamp
    message.pose.pose.position.x, message.pose.pose.position.y = pose[0], pose[1]
    message.pose.pose.orientation = quaternion(pose[2])
    message.twist.twist.linear.x, message.twist.twist.linear.y, message.twist.twist.angular.z = twist


def transform(stamp: rospy.Time, frame: str, child: str, pose: Sequence[float]) -> TransformStamped:
    message = TransformStamped()
    message.header.stamp = stamp
    message.header.frame_id = frame
    message.child_frame_id = child
    message.transform.translation.x, message.transform.translation.y = pose[0], pose[1]
    message.transform.rotation = quaternion(pose[2])
    return message


def scan_message(frame: str, ranger: protocol.RangerInfo) -> LaserScan:
    message = ArrayLaserScan()
    message.header.frame_id = frame
    message.angle_min = ranger.angle_min
    message.angle_max = ranger.angle_min + ranger.angle_increment * (ranger.samples - 1)
    message.angle_increment = ranger.angle_increment
    message.scan_time = ranger.update_interval
    message.range_min = ranger.range_min
    message.range_max = ranger.range_max
    message.intensities = np.empty(0, dtype=np.float32)
    return message


def device_names(name: str, count: int) -> list[str]:
    """Names of a robot's devices of one kind: numbered only when there are several, as stageros does."""
    return [name] if count == 1 else [f"{name}_{index}" for index in range(count)]
