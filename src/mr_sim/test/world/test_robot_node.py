"""The robot node without a master: its clock, how it ends."""

import math
from types import SimpleNamespace

import pytest

from mr_sim import robot_node, ros_io


@pytest.mark.parametrize("ending", [False, True], ids=["the world has died", "Ctrl-C"])
def test_a_connection_that_is_closed_at_shutdown_is_not_lost(ending, monkeypatch):
    """Each Ctrl-C of a simulated robot ended with an error: the connection is closed before ROS is shut down."""
    ends, errors = [], []
    monkeypatch.setattr(robot_node.rospy.core, "is_shutdown_requested", lambda: bool(ends))
    monkeypatch.setattr(robot_node.rospy, "is_shutdown", lambda: False)
    monkeypatch.setattr(robot_node.rospy, "logerr", errors.append)
    node = robot_node.RobotNode.__new__(robot_node.RobotNode)
    node._client = SimpleNamespace(receive=lambda: ends.append(1) if ending else None)
    assert (node.run(), errors) == ((0, []) if ending else (1, ["connection to the world lost"]))


def stamps_at(time, offsets, monkeypatch):
    """s: of the clock, the transform, the odometry and the scan at this time of the world, after these offsets."""
    said, nowhere = [], SimpleNamespace(get_num_connections=lambda: 0)
    monkeypatch.setattr(robot_node.rospy, "logwarn", lambda *_: None)
    node = robot_node.RobotNode.__new__(robot_node.RobotNode)
    node._prefix, node._offset, node._next_clock, node._truth = "", 0.0, 0.0, nowhere
    node._clock = SimpleNamespace(publish=said.append)
    node._transforms = SimpleNamespace(sendTransform=lambda message: said.append(message.header.stamp))
    node._odometry = SimpleNamespace(publish=lambda message: said.append(message.header.stamp))
    node._scans = [node._odometry]
    node._odometry_message = ros_io.odometry_message("odom", "base_footprint")
    node._scan_messages = [SimpleNamespace(header=SimpleNamespace(), ranges=())]
    for offset in offsets:
        node._on_offset(SimpleNamespace(data=offset))
    still = (0.0, 0.0, 0.0)
    node._publish_state(SimpleNamespace(time=time, odometry=still, wheels=still, pose=still, velocity=still))
    node._publish_ranges(SimpleNamespace(ranger=0, time=time, ranges=()))
    return [stamp.to_sec() for stamp in said]


@pytest.mark.parametrize(
    ("offsets", "expected"),
    [((), 10.0), ((60.0,), 70.0), ((-4.0,), 6.0), ((-20.0,), 0.0), ((60.0, 0.0), 10.0), ((5.0, math.nan, 1e9), 15.0)],
)
def test_all_stamps_follow_a_clock_that_is_wrong(offsets, expected, monkeypatch):
    assert stamps_at(10.0, offsets, monkeypatch) == [expected] * 4
