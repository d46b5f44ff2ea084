"""Sightings confirmed, refined or refuted by walls, on maps that the scenes' lasers have drawn."""

import math
from dataclasses import replace

import numpy as np
import pytest

from map_merger.meetings.confirmation import confirmed
from map_merger.meetings.values import Hypothesis
from map_merger.registration import Limits, Verdict
from map_merger.surface import landmarks_of
from map_merger.transform import displacement, rotation_between
from mr_grid import GridInfo, OccupancyGrid, Pose

RESOLUTION = 0.05


def plan(width_m=8.0, depth_m=6.0, notch=True):
    """A room, free inside, with a corner cut off; its centre is the origin."""
    rows, columns = round(depth_m / RESOLUTION), round(width_m / RESOLUTION)
    cells = np.full((rows, columns), 0, np.int8)
    cells[:2], cells[-2:], cells[:, :2], cells[:, -2:] = 100, 100, 100, 100
    if notch:
        cells[-30:, -40:] = 100
    return cells


def seen_from(cells, pose):
    """The plan (its centre at the origin) as a map whose frame is `pose` in the plan's frame."""
    rows, columns = cells.shape
    corner = Pose(-0.5 * columns * RESOLUTION, -0.5 * rows * RESOLUTION)
    return landmarks_of(OccupancyGrid(GridInfo(columns, rows, RESOLUTION, pose.inverse().compose(corner)), cells))


def hypothesis(transform, shift=0.05, turn=0.026, **fields):
    known = dict(
        transform=transform,
        covariance=np.diag([shift**2, shift**2, turn**2]),
        centre=(0.0, 0.0),
        samples=60,
        error=0.02,
        seconds=6.0,
        path=2.0,
        bend=0.6,
        mutual=True,
        share=1.0,
    )
    return Hypothesis(**{**known, **fields})


OWN, OTHER = Pose(-1.0, 0.5, 0.2), Pose(0.8, -0.7, -0.5)
TRUTH = OWN.inverse().compose(OTHER)
TARGET, SOURCE = seen_from(plan(), OWN), seen_from(plan(), OTHER)
NO_WALLS = landmarks_of(OccupancyGrid(GridInfo(100, 100, RESOLUTION), np.zeros((100, 100), np.int8)))


def error_of(transform):
    points = np.array([[x, y] for x in (-4.0, 0.0, 4.0) for y in (-3.0, 0.0, 3.0)])
    return displacement(transform, TRUTH, points).max()


def off(x=0.0, y=0.0, yaw=0.0):
    return Pose(TRUTH.x + x, TRUTH.y + y, TRUTH.yaw + yaw)


def test_walls_make_a_sighting_exact():
    rough = hypothesis(off(0.08, -0.06, math.radians(2.0)))
    result = confirmed(TARGET, SOURCE, [rough])
    assert result.registration.verdict is Verdict.ACCEPTED and result.registration.met and result.words == ""
    assert error_of(rough.transform) > 0.15 and error_of(result.registration.transform) < 0.03
    assert math.sqrt(result.covariance[2, 2]) < math.radians(0.5)


def test_walls_refute_what_was_mistaken():
    result = confirmed(TARGET, SOURCE, [hypothesis(off(1.5, 0.6))])
    assert result.registration.verdict is Verdict.CONTRADICTED
    assert "in free space" in result.words


def test_walls_decide_between_two_solutions():
    wrong, right = hypothesis(off(1.5, 0.6), samples=61), hypothesis(off(0.03))
    result = confirmed(TARGET, SOURCE, [wrong, right])
    assert result.registration.accepted and error_of(result.registration.transform) < 0.03


def test_two_solutions_that_the_walls_allow_wait():
    result = confirmed(NO_WALLS, NO_WALLS, [hypothesis(TRUTH), hypothesis(off(2.1), samples=50)])
    assert result.registration.verdict is Verdict.AMBIGUOUS and result.words == "two solutions 2.1 m apart"


def test_doubts_of_the_sightings_are_not_overruled_by_walls():
    """In a copy of the room the walls agree, too."""
    result = confirmed(TARGET, SOURCE, [hypothesis(TRUTH, doubts="waits to see b move")])
    assert result.registration.verdict is Verdict.UNSETTLED and result.words == "waits to see b move"


def test_in_an_open_hall_exact_sightings_are_enough():
    result = confirmed(NO_WALLS, NO_WALLS, [hypothesis(TRUTH, 0.02, math.radians(0.5))])
    assert result.registration.accepted and result.registration.transform == TRUTH


@pytest.mark.parametrize(("shift", "turn"), [(0.15, 0.5), (0.02, 2.0)])
def test_in_an_open_hall_rough_sightings_wait(shift, turn):
    result = confirmed(NO_WALLS, NO_WALLS, [hypothesis(TRUTH, shift, math.radians(turn))])
    assert result.registration.verdict is Verdict.INEXACT and "only" in result.words


def test_along_a_corridor_the_sightings_decide_and_its_walls_give_the_heading():
    cells = np.zeros((40, 200), np.int8)
    cells[:2], cells[-2:] = 100, 100
    target, source = seen_from(cells, OWN), seen_from(cells, OTHER)
    rough = hypothesis(off(yaw=math.radians(2.5)), 0.03, math.radians(1.5))
    result = confirmed(target, source, [rough])
    assert result.registration.accepted
    assert rotation_between(result.registration.transform, TRUTH) < math.radians(0.3)
    assert displacement(result.registration.transform, TRUTH, np.zeros((1, 2)))[0] < 0.1


def test_walls_do_not_drag_a_sighting_far_from_where_it_was():
    exact = hypothesis(off(0.3), 0.01, math.radians(0.2))
    transform = confirmed(TARGET, SOURCE, [exact]).registration.transform
    assert displacement(transform, exact.transform, np.zeros((1, 2)))[0] < 0.1


def test_the_covariance_grows_with_the_distance_from_where_the_robots_met():
    there = hypothesis(TRUTH, 0.02, math.radians(0.5), centre=(3.0, 0.0))
    result = confirmed(NO_WALLS, NO_WALLS, [there])
    at_origin = result.covariance_at_origin()
    assert at_origin[2, 2] == pytest.approx(result.covariance[2, 2])
    grown = np.trace(at_origin[:2, :2]) - np.trace(result.covariance[:2, :2])
    assert grown == pytest.approx(3.0**2 * result.covariance[2, 2])


def test_limits_and_nothing_seen():
    assert confirmed(TARGET, SOURCE, []).registration.verdict is Verdict.NO_CANDIDATE
    result = confirmed(TARGET, SOURCE, [hypothesis(TRUTH)], Limits(rotation=math.radians(5.0)))
    assert result.registration.verdict is Verdict.BEYOND_LIMITS


def test_a_hypothesis_may_pivot_anywhere():
    moved = replace(hypothesis(off(0.05, 0.05, math.radians(1.0))), centre=(2.0, 1.0))
    assert error_of(confirmed(TARGET, SOURCE, [moved]).registration.transform) < 0.03
