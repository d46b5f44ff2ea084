"""Goals of the action after the clock was set back. Without a master: handles are stand-ins."""

import threading
from types import SimpleNamespace

import actionlib
import pytest
import rospy

from mr_robot.navigation.action_server import LatestGoalServer

NOW = 58.0


class Handle:
    """Of a goal sent at `stamp`, s; None: of no goal."""

    def __init__(self, stamp):
        self.canceled = False
        self._goal_id = SimpleNamespace(id=str(stamp), stamp=None if stamp is None else rospy.Time.from_sec(stamp))

    def get_goal(self):
        return self._goal_id.stamp is not None

    def get_goal_id(self):
        return self._goal_id

    def set_canceled(self, *_):
        self.canceled = True


def server(current, coming=None):
    made = object.__new__(LatestGoalServer)
    made.execute_condition = threading.Condition(threading.RLock())
    made.current_goal, made.next_goal = Handle(current), Handle(coming)
    made.new_goal, made.preempt_callback, made.goal_callback = False, None, None
    made.is_active = lambda: False
    return made


@pytest.fixture(autouse=True)
def clock(monkeypatch):
    monkeypatch.setattr(rospy.Time, "now", lambda: rospy.Time.from_sec(NOW))


@pytest.mark.parametrize(("current", "coming"), [(108.0, None), (50.0, 108.0), (108.0, 109.0)])
def test_a_goal_after_the_clock_was_set_back_is_taken(current, coming):
    made, goal = server(current, coming), Handle(NOW)
    made.internal_goal_callback(goal)
    assert not goal.canceled and made.next_goal is goal and made.new_goal


def test_a_goal_that_another_one_has_overtaken_is_not():
    made, goal = server(57.0), Handle(56.0)
    made.internal_goal_callback(goal)
    assert goal.canceled and not made.new_goal


def test_the_status_is_told_on_when_the_clock_was_set_back(monkeypatch):
    ended, started = [], []
    made = server(None)
    timer = SimpleNamespace(shutdown=lambda: ended.append(True))
    made.action_server = SimpleNamespace(status_timer=timer, status_frequency=5.0, publish_status_async="tells")
    monkeypatch.setattr(actionlib.SimpleActionServer, "start", lambda self: None)
    monkeypatch.setattr(rospy, "Timer", lambda *given, **named: started.append((*given, named)))
    made.start()
    assert ended == [True] and started == [(rospy.Duration(0.2), "tells", {"reset": True})]
