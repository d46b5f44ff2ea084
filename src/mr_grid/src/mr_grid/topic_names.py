"""What is the name of a topic."""

import re


def is_topic_name(text: str) -> bool:
    """Whether ROS takes it, slashes one after the other as one."""
    return re.fullmatch(r"[~/A-Za-z][A-Za-z0-9_/]*", text) is not None
