"""Which ground other robots take up where the laser is blind."""

import math
from typing import Tuple

import numpy as np
import pytest
from usual_robot import navigation_with

from mr_grid import Pose
from mr_robot.navigation.options import STANDING, make_scan
from mr_robot.navigation.other_robots import OtherRobots

HERE = Pose(1.0, 2.0, 0.0)
BESIDE = (1.0, 3.0)  # m, where a laser that looks ahead is blind
VIEW = 1.0  # rad
SCAN = make_scan(np.full(101, math.inf), -0.5 * VIEW, VIEW / 100, 0.45, 4.0, Pose(0.0, 0.0, 0.0))


def robots(own: str, *reports: Tuple[Tuple[float, float], float]) -> OtherRobots:
    """`reports`: place (m, map frame) of robot_1 and when it came, s."""
    others = OtherRobots(navigation_with(), own)
    for place, at in reports:
        others.hear({"robot_1": place}, at)
    return others


def is_taken(others: OtherRobots, place: Tuple[float, float], now: float) -> bool:
    rims = others.unseen(now, HERE, SCAN)
    return bool(np.any(np.hypot(rims[:, 0] - place[0], rims[:, 1] - place[1]) < 0.05))


@pytest.mark.parametrize("place, taken", [(BESIDE, True), ((0.2, 2.0), True), ((2.0, 2.0), False), ((1.0, 4.0), False)])
def test_a_robot_counts_where_the_laser_is_blind_and_near(place: Tuple[float, float], taken: bool) -> None:
    others = robots("robot_2", (place, 0.0))
    assert is_taken(others, (place[0] + 0.25, place[1]), 0.1) == taken


def test_a_robot_counts_where_it_is_too_near_to_be_seen() -> None:
    """A Turtlebot that had waited close behind another one for longer than it remembers what it saw drove into it; its
    wheels slipped there, and its map was lost."""
    too_near, farther = robots("robot_2", ((1.4, 2.0), 0.0)), robots("robot_2", ((1.6, 2.0), 0.0))
    assert is_taken(too_near, (1.65, 2.0), 0.1), "its middle is 0.4 m away, and the sensor reads from 0.45 m on"
    assert not is_taken(farther, (1.85, 2.0), 0.1)


@pytest.mark.parametrize("own, yields", [("robot_2", True), ("robot_0", False)])
def test_of_two_robots_on_the_way_to_one_place_the_later_name_lets_the_other_pass(own: str, yields: bool) -> None:
    """Turtlebots that knew where both were drove into one another: each counted the other where it had been."""
    others = robots(own, ((0.6, 3.0), 0.0), ((0.8, 3.0), 0.4))  # drives past at 0.5 m/s
    assert is_taken(others, (1.35, 3.0), 0.4) == yields
    assert not is_taken(others, (1.9, 3.0), 0.4)


def test_who_stands_is_where_it_says() -> None:
    others = robots("robot_2", ((0.6, 3.0), 0.0), (BESIDE, 0.4), (BESIDE, 0.4 + STANDING))
    assert is_taken(others, (1.25, 3.0), 0.4 + STANDING) and not is_taken(others, (1.65, 3.0), 0.4 + STANDING)


def test_a_place_told_again_with_those_of_others_is_no_news() -> None:
    others = robots("robot_2", ((0.8, 3.0), 0.0), (BESIDE, 0.4), (BESIDE, 0.5))
    assert is_taken(others, (1.6, 3.0), 0.5)


def test_a_transform_that_jumps_is_no_speed() -> None:
    others = robots("robot_2", ((-9.0, 3.0), 0.0), (BESIDE, 0.4))
    assert not is_taken(others, (2.2, 3.0), 0.4)


def test_old_positions_and_such_of_the_future_tell_nothing_about_motion() -> None:
    long_ago = robots("robot_2", ((0.0, 3.0), 8.9 - STANDING), (BESIDE, 9.0))
    clock_set_back = robots("robot_2", ((0.8, 3.0), 9.0), (BESIDE, 9.4), (BESIDE, 0.0))
    for others, now in ((long_ago, 9.0), (clock_set_back, 0.0)):
        assert is_taken(others, (1.25, 3.0), now) and not is_taken(others, (1.55, 3.0), now)


def test_others_pass_nearer_to_robots_at_rest_than_to_such_that_may_move() -> None:
    """Between three robots that were home there was no way for the fourth: it stayed 2 m away."""
    options = navigation_with()
    others = robots("robot_2", (BESIDE, 0.0), (BESIDE, 5.0), ((BESIDE[0], BESIDE[1] + 0.02), 9.0))
    moving = [options.moving_margin, options.moving_reaction_time]
    rows = np.array([[1.2, 3.0, *moving], [2.0, 2.0, *moving]])
    assert others.settle(rows.copy(), 5.0).tolist() == rows.tolist()
    settled = others.settle(rows.copy(), 9.0)
    assert settled[0, 2:].tolist() == [options.obstacle_margin, 0.0] and settled[1].tolist() == rows[1].tolist()
    others.hear({"robot_1": (1.0, 3.2)}, 9.4)
    assert others.settle(rows.copy(), 9.4).tolist() == rows.tolist()


def test_a_robot_in_this_ones_own_place_is_none() -> None:
    """Explorer and navigation had other names for one robot: its own position held it up for good."""
    assert len(robots("robot_2", ((1.05, 2.02), 0.0)).unseen(0.1, HERE, SCAN)) == 0
    assert len(robots("robot_2", ((1.05, 2.25), 0.0)).unseen(0.1, HERE, SCAN)) > 0
