"""Wheels that turn while the robot stands."""

import math

from mr_robot.navigation.stall import StallWatch


def blocked_at(command: tuple, motion: float, turning: float = 0.0) -> float:
    """s until the watch calls a robot blocked that is given `command` (m/s, rad/s) and moves at `motion` m/s."""
    watch = StallWatch(0.1)
    for step in range(300):
        now = 0.1 * step
        if watch.blocked(now, (motion * now, 0.0, turning * now)):
            return now
        watch.command(now, command)
    return math.inf


def test_a_robot_that_stands_is_noticed_within_a_second() -> None:
    assert blocked_at((0.5, 0.0), 0.0) < 1.0
    assert blocked_at((0.0, 1.0), 0.0) < 1.0


def test_a_robot_that_follows_is_not() -> None:
    assert blocked_at((0.5, 0.0), 0.5) == math.inf
    assert blocked_at((0.5, 1.0), 0.5, 1.0) == math.inf
    assert blocked_at((0.0, 0.0), 0.0) == math.inf
    assert blocked_at((0.0, 1.7), 0.0, 1.7) == math.inf, "a whole turn is none in the pose"


def test_a_clock_that_was_set_back_starts_anew() -> None:
    watch = StallWatch(0.1)
    for now in (10.0, 10.1, 10.2, 10.3, 10.4, 10.5, 10.6):
        watch.blocked(now, (0.0, 0.0, 0.0))
        watch.command(now, (0.5, 0.0))
    assert watch.blocked(10.7, (0.0, 0.0, 0.0))
    for now in (1.0, 1.1, 1.2, 1.3):
        assert not watch.blocked(now, (0.0, 0.0, 0.0))
        watch.command(now, (0.5, 0.0))
    assert any(watch.blocked(1.4 + 0.1 * step, (0.0, 0.0, 0.0)) for step in range(3)), "it still watches"


def test_a_robot_that_creeps_against_something_is_noticed() -> None:
    """Three Turtlebots wedged into one another pressed at 0.03 m/s for as long as their manoeuvres lasted."""
    assert blocked_at((-0.03, 0.0), 0.0) < 4.0
    assert blocked_at((-0.03, 0.0), -0.03) == math.inf


def test_a_robot_that_drives_to_and_fro_is_not() -> None:
    """Two robots met in a corridor; the one that gave way backed off well, but braking before the other one had made
    its way a little shorter than asked for, and little was left of to and fro. It took that for something behind it."""
    watch, place = StallWatch(0.1), 0.0
    for step in range(40):
        now = 0.1 * step
        command, motion = (0.4, 0.32) if now < 1.0 else (0.0, 0.0) if now < 1.5 else (-0.26, -0.26)
        assert not watch.blocked(now, (place, 0.0, 0.0))
        watch.command(now, (command, 0.0))
        place += 0.1 * motion
