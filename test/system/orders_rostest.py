#!/usr/bin/env python3
"""A mission control starts a team, limits it and stops it over the radio: only frames, of which every tenth is lost,
are between the base station and the explorers of the two robots. The robots have no map: that they were started shows
in that they cannot be started again."""

import functools
import sys
import time
import unittest
from typing import Any, Callable, Dict, List

import rospy
import rostest
from explorer.msg import ExplorationState, TeamOverview
from explorer.srv import SetLimits
from std_srvs.srv import Trigger

ROBOTS = ["anna", "bob"]
DEADLINE_S = 30.0


class Orders(unittest.TestCase):
    def setUp(self) -> None:
        self.states: Dict[str, str] = {}
        self.team = TeamOverview()
        for name in ROBOTS:
            rospy.Subscriber(f"/{name}/explorer/state", ExplorationState, functools.partial(self.on_state, name))
        rospy.Subscriber("/base/mission_control/team", TeamOverview, self.on_team)

    def on_state(self, name: str, message: ExplorationState) -> None:
        self.states[name] = message.text

    def on_team(self, message: TeamOverview) -> None:
        self.team = message

    def until(self, done: Callable[[], bool]) -> None:
        end = time.monotonic() + DEADLINE_S
        while not done():
            self.assertLess(time.monotonic(), end, f"{self.states} {self.team}")
            time.sleep(0.1)

    def until_all_say(self, state: str, answer: str) -> None:
        """On the robots, and what of it came back to the base."""
        self.until(lambda: [self.states.get(name, "") for name in ROBOTS] == [state] * len(ROBOTS))
        self.until(lambda: self.told("text") == [state] * len(ROBOTS))
        self.until(lambda: all(one.startswith(answer) for one in self.told("order_answer")))

    def told(self, field: str) -> List[Any]:
        """Of each robot in the overview of the base."""
        return [getattr(robot.state, field) for robot in self.team.robots]

    def call(self, name: str, kind: Any, *values: float) -> None:
        rospy.wait_for_service(f"/base/mission_control/{name}", DEADLINE_S)
        answer = rospy.ServiceProxy(f"/base/mission_control/{name}", kind)(*values)
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(answer.message, f"{name}: sent to anna, bob")

    def test_a_team_is_started_limited_and_stopped(self) -> None:
        self.until(lambda: [robot.state.robot_name for robot in self.team.robots if robot.in_reach] == ROBOTS)
        self.call("start", Trigger)
        self.until_all_say("waits for the map", "exploration started")
        for name in ROBOTS:
            again = rospy.ServiceProxy(f"/{name}/explorer/start", Trigger)()
            self.assertFalse(again.success, "it was started by the base")
        self.call("set_limits", SetLimits, 600.0, 0.0)
        self.until_all_say("waits for the map", "ends after 600 s")
        self.call("stop", Trigger)
        self.until_all_say("stopped", "stopped")


if __name__ == "__main__":
    rospy.init_node("orders")
    rostest.rosrun("mr_test", "orders", Orders, sys.argv)
