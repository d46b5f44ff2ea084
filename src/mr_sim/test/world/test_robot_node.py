"""The robot node without a master: how it ends."""

from types import SimpleNamespace

import pytest

from mr_sim import robot_node


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
