"""Planar poses in ROS messages, and names of frames and topics in parameters."""

from typing import Dict, Mapping

import rospy
from geometry_msgs.msg import TransformStamped
from rosgraph.names import is_legal_name

from mr_grid import Pose
from mr_grid.ros import yaw_of


class ParameterError(ValueError):
    """A parameter that cannot be; the text names it."""


def transform_pose(message: TransformStamped) -> Pose:
    translation = message.transform.translation
    return Pose(translation.x, translation.y, yaw_of(message.transform.rotation))


def frame_name(name: str) -> str:
    """As tf2 knows it: drivers of its forerunner begin names with a slash."""
    return name.lstrip("/")


def frame_parameters(defaults: Mapping[str, str]) -> Dict[str, str]:
    """Private parameters of the node."""
    return {key: frame_name(str(rospy.get_param("~" + key, name))) for key, name in defaults.items()}


def topic_parameters(defaults: Mapping[str, str]) -> Dict[str, str]:
    """Private parameters of the node. Raises ParameterError for one that no topic can be named."""
    topics = {key: rospy.get_param("~" + key, name) for key, name in defaults.items()}
    for key, topic in topics.items():
        if not isinstance(topic, str) or not topic or not is_legal_name(topic):
            raise ParameterError(f"parameter ~{key} must be the name of a topic, not {topic!r}")
    return topics
