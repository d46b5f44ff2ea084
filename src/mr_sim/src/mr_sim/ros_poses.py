"""Planar poses in ROS messages."""

import math

from geometry_msgs.msg import Quaternion, TransformStamped

from mr_grid import Pose


def yaw_of(q: Quaternion) -> float:
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


def quaternion(yaw: float) -> Quaternion:
    return Quaternion(0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0))


def transform_pose(message: TransformStamped) -> Pose:
    translation = message.transform.translation
    return Pose(translation.x, translation.y, yaw_of(message.transform.rotation))
