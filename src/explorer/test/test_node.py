"""The node without a master: what it shares between the threads of rospy."""

import pkgutil
from types import SimpleNamespace
from typing import Any, Callable, List

import pytest
from usual_robot import options_with

import explorer

# The generated messages lie in a folder of their own, and where ROS is not installed there are none.
explorer.__path__ = pkgutil.extend_path(explorer.__path__, "explorer")
for package in (
    "actionlib",
    "adhoc_communication.msg",
    "explorer.msg",
    "map_merger.srv",
    "move_base_msgs.msg",
    "rospy",
):
    pytest.importorskip(package, reason="ROS is not here")

from explorer import ros_node  # noqa: E402
from explorer.agent import ExplorerAgent  # noqa: E402


class LockTakenBefore:
    """A lock that another thread holds when it is asked for the first time; `meanwhile` is what that thread does."""

    def __init__(self, meanwhile: Callable[[], None]) -> None:
        self._meanwhile: List[Callable[[], None]] = [meanwhile]

    def __enter__(self) -> None:
        if self._meanwhile:
            self._meanwhile.pop()()

    def __exit__(self, *_: Any) -> None:
        pass


@pytest.fixture
def node(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr(ros_node.rospy, "get_time", lambda: 1.0)
    made = ros_node.ExplorerNode.__new__(ros_node.ExplorerNode)
    made._options = options_with(robot_name="robot_0")
    made._agent = ExplorerAgent(made._options)
    return made


@pytest.mark.parametrize("present, expected", [(True, ["robot_1", "robot_2", "robot_3"]), (False, ["robot_1"])])
def test_robots_that_are_told_at_once_by_two_threads_are_all_known(node: Any, present: bool, expected: list) -> None:
    """The list of robots was read outside of the lock, so what came in meanwhile was lost."""
    status = SimpleNamespace(robot_name="", robots=["robot_1", "robot_2"])
    node._lock = LockTakenBefore(lambda: node._on_status(status))
    node._on_robot(SimpleNamespace(data="robot_3" if present else "robot_2"), present)
    assert node._agent.mission.team.known() == expected
