"""The node without a master: when it has caught up with what came."""

import pkgutil
import queue
import threading
from types import SimpleNamespace

import pytest

import map_merger

# The generated messages lie in a folder of their own, and where ROS is not installed there are none.
map_merger.__path__ = pkgutil.extend_path(map_merger.__path__, "map_merger")
for package in ("adhoc_communication.msg", "map_merger.msg", "rospy", "tf2_ros"):
    pytest.importorskip(package, reason="ROS is not here")

from map_merger import ros_node  # noqa: E402
from mr_grid.rounds import Rounds  # noqa: E402

PATIENCE_S = 10.0


def test_it_has_when_the_registration_under_way_has_ended(monkeypatch):
    """A replay went on meanwhile, and ended before a transform was there."""
    begun, may_end, caught_up, taken = threading.Event(), threading.Event(), threading.Event(), []

    def search(job):
        begun.set()
        assert may_end.wait(PATIENCE_S)
        return "result", None

    monkeypatch.setattr(ros_node, "outcome_of", search)
    node = ros_node.MapMergerNode.__new__(ros_node.MapMergerNode)
    node._rounds, node._wake, node._jobs = Rounds(), threading.Event(), queue.Queue(2)
    node._agent = SimpleNamespace(on_registered=lambda effect, result, now: taken.append(result))
    node._do = lambda call: call(0.0)
    threading.Thread(target=node._register_all, daemon=True).start()
    node._jobs.put(SimpleNamespace(job=SimpleNamespace(robot="robot_1")))
    assert begun.wait(PATIENCE_S)

    waiting = threading.Thread(target=lambda: (node._catch_up(None), caught_up.set()), daemon=True)
    waiting.start()
    assert node._wake.wait(PATIENCE_S), "the loop is not to wait for its time"
    with node._rounds.next_one():
        pass
    waiting.join(0.1)
    assert not caught_up.is_set()
    may_end.set()
    assert caught_up.wait(PATIENCE_S) and taken == ["result"]
