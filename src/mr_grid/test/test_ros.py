"""Maps and poses through ROS messages."""

import math

import numpy as np
import pytest
import rospy
from geometry_msgs.msg import Quaternion
from hypothesis import given
from hypothesis import strategies as st
from rospy.exceptions import TransportTerminated

from mr_grid import FARTHEST, GridError, OccupancyGrid, Pose
from mr_grid.ros import (
    CALL_FAILED,
    grid_message,
    grid_value,
    pose_message,
    pose_value,
    quaternion,
    reason_of,
    typed_fields,
    yaw_of,
)

METRES = st.floats(-FARTHEST, FARTHEST)
CELLS = np.array([[0, 100, -1], [50, 7, 0]], np.int8)


@given(METRES, METRES, st.floats(-math.pi, math.pi, exclude_min=True))
def test_a_pose_comes_back(x, y, yaw):
    value = pose_value(pose_message(Pose(x, y, yaw)))
    assert value[:2] == (x, y) and yaw_of(quaternion(yaw)) == value.yaw
    assert abs(math.remainder(value.yaw - yaw, 2.0 * math.pi)) < 1e-9


def test_a_map_comes_back():
    grid = OccupancyGrid.of(CELLS, 0.05, Pose(-1.0, 2.0, 0.0))
    message = grid_message(grid, "map", rospy.Time(3))
    assert (message.header.frame_id, message.header.stamp) == ("map", rospy.Time(3))
    assert (message.info.height, message.info.width) == (2, 3)
    assert grid_value(message).equals(grid)
    message.data = message.data.tolist()
    assert grid_value(message).equals(grid)


def test_an_origin_without_orientation_is_not_turned():
    message = grid_message(OccupancyGrid.of(CELLS, 0.05), "map", rospy.Time())
    message.info.origin.orientation = Quaternion()
    assert grid_value(message).origin == Pose()


def changed(path, value):
    message = grid_message(OccupancyGrid.of(CELLS, 0.05), "map", rospy.Time())
    owner, name = message, path.split(".")
    for part in name[:-1]:
        owner = getattr(owner, part)
    setattr(owner, name[-1], value)
    return message


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("info.width", 4, "holds 6 cells, its description says 4 x 2"),
        ("info.resolution", 0.0, "resolution"),
        ("info.origin.position.x", math.nan, "not finite"),
        ("info.origin.position.y", 1e300, "above 100000"),
        ("info.origin.orientation", Quaternion(0.0, 0.0, 0.0, 1e-9), "quaternion of length 0"),
        ("data", np.zeros(0, np.int8), "holds 0 cells"),
    ],
)
def test_bad_messages_are_refused_with_the_culprit(path, value, words):
    with pytest.raises(GridError, match=words):
        grid_value(changed(path, value))


def test_a_node_that_ends_while_a_call_is_written_to_it_is_a_failed_call() -> None:
    """The thread that called ended for good: a map merger never told its map again."""
    assert issubclass(TransportTerminated, CALL_FAILED)


@pytest.mark.parametrize("words", ["not delivered to robot_1 (robot_1 was lost)", 'it\'s "so"', "Tür\n2"])
def test_a_refusal_is_told_in_the_words_of_the_service(words: str) -> None:
    """Warnings and replays showed them as rospy wraps them: service [/name] responded with an error: b'...'."""
    error = rospy.ServiceException(f"service [/adhoc_communication/send] responded with an error: {words.encode()!r}")
    assert reason_of(error) == words
    assert reason_of(rospy.ServiceException("service [/x] unavailable")) == "service [/x] unavailable"


@pytest.mark.parametrize("length", [0.5, 1.09, 2.0])
def test_a_heading_is_the_same_at_any_length_of_its_quaternion(length):
    q = quaternion(1.0)
    q.x, q.y, q.z, q.w = (length * value for value in (q.x, q.y, q.z, q.w))
    assert yaw_of(q) == pytest.approx(1.0)


def test_fields_of_a_message_of_any_type():
    fields = typed_fields(Quaternion(0.0, 0.0, 1.0, 0.0))
    assert fields["type"] == "geometry_msgs/Quaternion" and fields["md5sum"] == Quaternion._md5sum
    assert "float64 w" in fields["definition"] and Quaternion().deserialize(fields["data"]).z == 1.0
