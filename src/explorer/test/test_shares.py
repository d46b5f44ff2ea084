"""Stops shared out among robots: every stop once, claims kept, near to the best there is by brute force."""

import itertools
import math
from typing import List, Optional, Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explorer.shares import POWER, Errand, arrivals, share_out


def errand(robots: np.ndarray, stops: np.ndarray, first: Sequence[Optional[int]], service: float = 1.0) -> Errand:
    """Places in the plane, (n, 2) in metres."""
    gaps = np.linalg.norm(stops[:, None] - stops[None], axis=2)
    starts = np.linalg.norm(robots[:, None] - stops[None], axis=2)
    return Errand(starts, gaps, np.full(len(stops), service), first)


def some(robots: int, stops: int, seed: int, first: Sequence[Optional[int]] = ()) -> Errand:
    random = np.random.default_rng(seed)
    return errand(random.uniform(0, 20, (robots, 2)), random.uniform(0, 20, (stops, 2)), first or [None] * robots)


def length(what: Errand, robot: int, tour: Sequence[int]) -> float:
    if not tour:
        return 0.0
    stop, there = arrivals(what, robot, tour)[-1]
    return there + float(what.service[stop])


def counted(what: Errand, tours: Sequence[Sequence[int]]) -> float:
    return sum(length(what, robot, tour) ** POWER for robot, tour in enumerate(tours))


def best(what: Errand) -> float:
    robots, stops = what.starts.shape
    found = math.inf
    for holders in itertools.product(range(robots), repeat=stops):
        parts: List[List[int]] = [[s for s in range(stops) if holders[s] == r] for r in range(robots)]
        lengths = [min(length(what, r, t) for t in itertools.permutations(part)) for r, part in enumerate(parts)]
        found = min(found, sum(one**POWER for one in lengths))
    return found


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 8), st.integers(0, 20), st.integers(0, 10**6))
def test_every_stop_is_in_one_tour_and_what_is_claimed_comes_first(robots: int, stops: int, seed: int) -> None:
    first = [robot if robot < stops and robot % 2 else None for robot in range(robots)]
    tours = share_out(some(robots, stops, seed, first))
    assert sorted(stop for tour in tours for stop in tour) == list(range(stops))
    assert all(tours[robot][0] == stop for robot, stop in enumerate(first) if stop is not None)


@pytest.mark.parametrize("seed", range(6))
def test_tours_are_near_to_the_best(seed: int) -> None:
    what = some(2, 5, seed)
    ratio = counted(what, share_out(what)) / best(what)
    assert 1.0 - 1e-9 <= ratio < 2.0


def test_a_robot_nearby_does_not_take_all() -> None:
    """One robot amid the stops and one 8 m off: the sum of the ways alone would leave everything to the first."""
    stops = np.array([[x, 0.0] for x in (-6.0, -4.0, -2.0, 2.0, 4.0, 6.0)])
    tours = share_out(errand(np.array([[0.0, 0.0], [8.0, 4.0]]), stops, [None, None], service=3.0))
    assert set(tours[1]) >= {4, 5} and set(tours[0]) >= {0, 1, 2}


def test_where_nobody_can_go_nobody_goes() -> None:
    what = some(2, 3, 0)
    what.starts[:, 1] = math.inf
    what.between[1, :] = what.between[:, 1] = math.inf
    assert sorted(stop for tour in share_out(what) for stop in tour) == [0, 2]
    assert share_out(some(3, 0, 0)) == [[], [], []]
