"""The same names as ROS takes, without ROS."""

import re

from hypothesis import example, given
from hypothesis import strategies as st
from rosgraph.names import is_legal_name

from mr_grid.topic_names import is_topic_name


@given(st.text("ab_/~1 -\n", max_size=6))
@example("a b")
@example("base_scan")
def test_names_are_those_of_ros(text: str) -> None:
    # ROS takes the empty name, and one that ends in a line end.
    named = bool(text) and "\n" not in text and is_legal_name(re.sub("/+", "/", text))
    assert is_topic_name(text) == named
