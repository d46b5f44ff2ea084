"""Planar poses in ROS messages."""

from geometry_msgs.msg import TransformStamped

from mr_grid import Pose
from mr_grid.ros import yaw_of


def transform_pose(message: TransformStamped) -> Pose:
    translation = message.transform.translation
    return Pose(translation.x, translation.y, yaw_of(message.transform.rotation))
