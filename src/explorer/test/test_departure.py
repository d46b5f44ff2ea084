"""Who drives off first."""

import math

import pytest

from explorer.departure import APART, LONGEST, Departure
from explorer.team import Team

NARROW = 1.0  # rad


def departure(name, field_of_view=NARROW, robots=4):
    team = Team(name, 30.0)
    team.set_known([f"robot_{index}" for index in range(robots)])
    return Departure(name, field_of_view, team), team


@pytest.mark.parametrize("name, earlier", [("robot_0", 0), ("robot_1", 1), ("robot_3", 3)])
def test_each_lets_those_before_it_drive_off(name, earlier):
    """Turtlebots side by side, which did not know yet where the others were, drove into one another."""
    waiting, _ = departure(name)
    assert len(waiting.awaited(0.0, 0.0)) == earlier
    assert not waiting.awaited(APART * earlier, 100.0)


def test_who_is_placed_is_not_waited_for():
    waiting, team = departure("robot_2")
    team.set_positions({"robot_0": (3.0, 0.0)}, 0.0)
    assert waiting.awaited(0.0, 0.0) == ["robot_1"]
    team.set_positions({"robot_0": (3.0, 0.0), "robot_1": (2.0, 0.0)}, 0.0)
    assert not waiting.awaited(0.0, 0.0)


def test_the_last_of_a_large_team_does_not_wait_longer():
    waiting, _ = departure("robot_9", robots=10)
    assert waiting.awaited(LONGEST - 0.5, 0.0) and not waiting.awaited(LONGEST, 0.0)


def test_robots_that_see_around_and_robots_alone_wait_for_nobody():
    assert not departure("robot_3", field_of_view=1.5 * math.pi)[0].awaited(0.0, 0.0)
    assert not departure("robot_0", robots=1)[0].awaited(0.0, 0.0)
