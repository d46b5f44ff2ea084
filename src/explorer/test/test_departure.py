"""Who drives off first."""

import math

import numpy as np
import pytest

from explorer.departure import APART, BOXED_IN, LONGEST, ROUND, Departure
from explorer.grid import OccupancyMap
from explorer.team import Team
from mr_grid import Pose

NARROW = 1.0  # rad
RADIUS = 0.25  # m
HERE = Pose(0.0, 0.0, 0.5 * math.pi)


def map_of(*obstacles):
    """6 m x 6 m of free ground around the robot with walls at places in m."""
    cells = np.zeros((120, 120), dtype=np.int8)
    for x, y in obstacles:
        cells[int((y + 3.0) / 0.05), int((x + 3.0) / 0.05)] = 100
    return OccupancyMap.of(cells, 0.05, Pose(-3.0, -3.0))


FREE, BLOCKED = map_of(), map_of((0.2, 1.5))


class Robot:
    def __init__(self, name, field_of_view=NARROW, robots=4, grid=FREE):
        self.team = Team(name, 30.0)
        self.team.set_known([f"robot_{index}" for index in range(robots)])
        self.grid = grid
        self._departure = Departure(name, field_of_view, RADIUS, self.team)

    def awaited(self, now):
        """`now`: s, the mission began at 0."""
        return list(self._departure.awaited(0.0, HERE, self.grid, now))

    def sees_off(self, name, now):
        self.team.claim(name, [(name, 1)], now)


@pytest.mark.parametrize("name, earlier", [("robot_0", 0), ("robot_1", 1), ("robot_3", 3)])
def test_each_lets_those_before_it_drive_off(name, earlier):
    """Turtlebots side by side, which did not know yet where the others were, drove into one another."""
    robot = Robot(name)
    assert len(robot.awaited(0.0)) == earlier
    assert not robot.awaited(ROUND * earlier)


def test_who_drives_off_gets_a_lead():
    robot = Robot("robot_1")
    robot.sees_off("robot_3", 1.0)
    assert robot.awaited(1.0) == ["robot_3"]
    assert robot.awaited(0.9 + APART) == ["robot_3"]
    assert robot.awaited(1.0 + APART) == ["robot_0"]
    assert not robot.awaited(1.0 + APART + ROUND)


def test_one_behind_another_lets_all_of_them_drive_off():
    """The first by name stood behind a robot, drove to and fro beside it for half a minute, and was run into."""
    robot = Robot("robot_0", grid=BLOCKED)
    assert robot.awaited(0.0) == ["robot_1", "robot_2", "robot_3"]
    robot.sees_off("robot_2", 4.0)
    robot.grid = FREE
    assert robot.awaited(4.0) == ["robot_2"]
    assert not robot.awaited(4.0 + APART)


def test_all_before_a_wall_drive_off_nevertheless():
    robots = [Robot(f"robot_{index}", grid=BLOCKED) for index in range(4)]
    left = {}
    for now in np.arange(0.0, LONGEST, 0.1):
        for index, robot in enumerate(robots):
            if index not in left and not robot.awaited(now):
                left[index] = now
                for other in robots:
                    other.sees_off(f"robot_{index}", now)
    times = sorted(left.values())
    assert len(times) == 4 and times[0] == pytest.approx(BOXED_IN, abs=0.2)
    assert min(np.diff(times)) >= APART


def test_the_last_one_behind_nobody_drives_off():
    robot = Robot("robot_0", robots=2, grid=BLOCKED)
    robot.sees_off("robot_1", 1.0)
    assert robot.awaited(1.0) == ["robot_1"]
    assert not robot.awaited(1.0 + APART)


def test_who_drives_off_does_not_stop_for_what_comes_into_its_way():
    robot = Robot("robot_0")
    assert not robot.awaited(0.0)
    robot.grid = BLOCKED
    assert not robot.awaited(1.0)


def test_who_is_placed_is_not_waited_for():
    robot = Robot("robot_2")
    robot.team.set_positions({"robot_0": (3.0, 0.0)}, 0.0)
    assert robot.awaited(0.0) == ["robot_1"]
    robot.team.set_positions({"robot_0": (3.0, 0.0), "robot_1": (2.0, 0.0)}, 0.0)
    assert not robot.awaited(0.0)


def test_the_last_of_a_large_team_does_not_wait_for_ever():
    robot = Robot("robot_9", robots=20)
    for index in range(6):
        robot.sees_off(f"robot_{index}", APART * index)
        assert robot.awaited(APART * index)
    assert robot.awaited(LONGEST - 0.1)
    assert not robot.awaited(LONGEST)


def test_robots_that_see_around_and_robots_alone_wait_for_nobody():
    assert not Robot("robot_3", field_of_view=1.5 * math.pi).awaited(0.0)
    assert not Robot("robot_0", robots=1).awaited(0.0)
