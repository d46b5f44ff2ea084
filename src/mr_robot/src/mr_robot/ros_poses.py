"""Planar poses and frames in ROS messages and parameters."""

from typing import Dict, Mapping

import rospy
from geometry_msgs.msg import TransformStamped

from mr_grid import Pose
from mr_grid.ros import yaw_of


def transform_pose(message: TransformStamped) -> Pose:
    translation = message.transform.translation
    return Pose(translation.x, translation.y, yaw_of(message.transform.rotation))


def frame_name(name: str) -> str:
    """As tf2 knows it: drivers of its forerunner begin names with a slash."""
    return name.lstrip("/")


def frame_parameters(defaults: Mapping[str, str]) -> Dict[str, str]:
    """Private parameters of the node."""
    return {key: frame_name(str(rospy.get_param("~" + key, name))) for key, name in defaults.items()}
