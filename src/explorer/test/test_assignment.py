"""Hungarian assignment against brute force; interpolation of missing bids; tours against brute force."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explorer.assignment import assign, cost_matrix, squared_euclidean
from explorer.tour import MAXIMUM_STOPS, tour_lengths


def brute_force(costs: np.ndarray) -> float:
    rows, columns = costs.shape
    if rows < columns:
        return brute_force(costs.T)
    orders = itertools.permutations(range(rows), columns)
    return min(sum(costs[r, c] for c, r in enumerate(chosen)) for chosen in orders)


@settings(max_examples=200)
@given(st.integers(1, 5), st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_optimal_for_any_shape(rows: int, columns: int, seed: int) -> None:
    costs = np.random.default_rng(seed).uniform(0, 100, (rows, columns))
    chosen = assign(costs)
    assert len(chosen) == min(rows, columns)
    assert len(set(chosen.values())) == len(chosen)
    assert sum(costs[r, c] for c, r in chosen.items()) == pytest.approx(brute_force(costs))


def test_impossible_pairs_are_not_assigned() -> None:
    assert assign(np.array([[math.inf, 3.0]])) == {1: 0}
    assert assign(np.array([[math.inf]])) == {}
    assert assign(np.zeros((0, 3))) == {}
    # As many pairs as possible, even if one alone would be cheaper.
    assert assign(np.array([[1.0, 2.0], [50.0, math.inf]])) == {0: 1, 1: 0}


def test_missing_bids_are_interpolated_from_the_position() -> None:
    centres = [(0.0, 0.0), (10.0, 0.0)]
    costs = cost_matrix(
        2,
        ["robot_1", "robot_2", "robot_3"],
        {"robot_1": {0: 4.0, 1: -1.0}},
        {"robot_1": (9.0, 0), "robot_2": (1.0, 0)},
        lambda position, row: squared_euclidean(position, centres[row]),
    )
    assert costs[:, 0].tolist() == [4.0, 1.0]
    assert costs[:, 1].tolist() == [1.0, 81.0]
    assert np.isinf(costs[:, 2]).all()


def test_paper_bid_is_the_integer_part_of_the_squared_distance() -> None:
    assert squared_euclidean((0, 0), (1.5, 0.9)) == 3.0


@settings(max_examples=40)
@given(st.integers(1, 6), st.integers(0, 2**32 - 1))
def test_tours_are_shortest(stops: int, seed: int) -> None:
    places = np.random.default_rng(seed).uniform(0, 20, (stops + 1, 2))
    ways = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
    found = tour_lengths(ways[0, 1:], ways[1:, 1:])
    for first in range(stops):
        rest = [k for k in range(stops) if k != first]
        best = min(
            sum(ways[a, b] for a, b in zip((0, first + 1, *order), (first + 1, *order)))
            for order in itertools.permutations([k + 1 for k in rest])
        )
        assert found[first] == pytest.approx(best)


def test_too_many_stops_are_refused() -> None:
    with pytest.raises(ValueError, match="at most"):
        tour_lengths(np.ones(MAXIMUM_STOPS + 1), np.ones((MAXIMUM_STOPS + 1, MAXIMUM_STOPS + 1)))
