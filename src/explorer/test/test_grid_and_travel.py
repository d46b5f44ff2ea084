"""Grid geometry, lines of sight and travel costs."""

import math
import time

import numpy as np
import pytest
from conftest import drawn, map_of
from hypothesis import given, settings
from hypothesis import strategies as st
from usual_robot import LARGEST

from explorer._kernels import lines_are_clear
from explorer.errors import MapError
from explorer.grid import OccupancyMap, line_is_clear
from explorer.ground import Ground
from explorer.travel import MAXIMUM_CELLS, TravelGrid
from mr_grid import GridInfo, Pose


@given(st.floats(0.01, 1.0), st.floats(-50, 50), st.floats(-50, 50), st.integers(0, 400), st.integers(0, 400))
def test_cell_and_centre_are_inverse(resolution: float, x: float, y: float, row: int, col: int) -> None:
    info = GridInfo(500, 500, resolution, Pose(x, y))
    assert info.cell_of(*info.centre_of(row, col)) == (row, col)
    assert (info.cells_of(info.centres_of(np.array([[row, col]]))) == [[row, col]]).all()


@pytest.mark.parametrize(
    "info, culprit",
    [
        (GridInfo(0, 0, 0.1), "0 x 0 cells"),
        (GridInfo(2, 2, 0.1, Pose(0.0, -1e300)), "origin is .* within"),
        (GridInfo(2, 2, 0.1, Pose(0.0, 0.0, 0.1)), "origin is rotated"),
    ],
)
def test_bad_maps_are_refused_with_the_culprit(info: GridInfo, culprit: str) -> None:
    with pytest.raises(MapError, match=culprit):
        OccupancyMap(info, np.zeros(info.shape, dtype=np.int8))


def test_one_cell_map_works() -> None:
    grid = TravelGrid(map_of([[0]]), 0.2, 0.6)
    assert grid.field_from(0.05, 0.05).at(0.05, 0.05) == 0.0


def test_walls_block_the_line_but_not_its_ends() -> None:
    blocked = np.zeros((5, 9), dtype=bool)
    blocked[:, 4] = True
    assert not line_is_clear(blocked, (2, 1), (2, 7))
    assert line_is_clear(blocked, (2, 1), (2, 4))
    assert not line_is_clear(blocked, (2, 1), (2, 20))


@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1))
def test_many_lines_agree_with_single_ones(seed: int) -> None:
    random = np.random.default_rng(seed)
    blocked = random.random((20, 20)) < 0.1
    starts, ends = random.integers(0, 20, (12, 2)), random.integers(0, 20, (12, 2))
    many = lines_are_clear(blocked, starts, ends)
    single = [line_is_clear(blocked, tuple(a), tuple(b)) for a, b in zip(starts, ends)]
    # Sampled at different densities the two may differ where a line grazes a corner, so compare a safe case only.
    lengths = np.abs(ends - starts).max(axis=1)
    longest = lengths == lengths.max()
    assert [bool(v) for v in many[longest]] == [single[i] for i in np.flatnonzero(longest)]


ROOMS = [
    "####################",
    "#........#.........#",
    "#........#.........#",
    "#........#.........#",
    "#..................#",
    "#........#.........#",
    "#........#.........#",
    "####################",
]


def test_cost_leads_through_the_door() -> None:
    occupancy = drawn(ROOMS, scale=10, resolution=0.1)
    grid = TravelGrid(occupancy, 0.25, 0.6)
    field = grid.field_from(2.0, 6.5)
    straight = math.hypot(17.0 - 2.0, 0.0)
    assert straight < field.at(17.0, 6.5) < 2.0 * straight
    path = field.path_to(17.0, 6.5)
    assert math.hypot(path[0][0] - 2.0, path[0][1] - 6.5) < 0.2
    assert any(abs(x - 9.5) < 0.3 and abs(y - 3.5) < 0.4 for x, y in path)
    steps = np.hypot(*np.diff(np.array(path), axis=0).T)
    assert steps.max() < 0.2


def test_inflation_closes_a_narrow_door() -> None:
    occupancy = drawn(ROOMS, scale=10, resolution=0.05)
    assert math.isfinite(TravelGrid(occupancy, 0.2, 0.6).field_from(1.0, 1.75).at(8.0, 1.75))
    assert math.isinf(TravelGrid(occupancy, 0.3, 0.6).field_from(1.0, 1.75).at(8.0, 1.75))


def test_what_another_robot_looks_like_does_not_block() -> None:
    occupancy = drawn(ROOMS, scale=10, resolution=0.1)
    cells = occupancy.cells.copy()
    cells[33:38, 93:98] = 100
    blocked = map_of(cells)
    assert math.isinf(TravelGrid(blocked, 0.25, 0.6).field_from(2.0, 2.0).at(15.0, 2.0))
    seen = TravelGrid(blocked, 0.25, 0.6, ground=Ground.of(blocked, 0.25, [(9.5, 3.5)], LARGEST))
    assert math.isfinite(seen.field_from(2.0, 2.0).at(15.0, 2.0))


def test_robot_outside_of_free_space_reaches_nothing() -> None:
    grid = TravelGrid(drawn(ROOMS, scale=10, resolution=0.1), 0.25, 0.6)
    assert not grid.field_from(-30.0, 2.0).reachable.any()


def test_large_maps_stay_workable() -> None:
    cells = np.zeros((1200, 1200), dtype=np.int8)
    cells[::100] = 100
    cells[:, 50:70] = 0
    begin = time.process_time()
    grid = TravelGrid(map_of(cells, 0.05), 0.25, 0.6)
    grid.field_from(3.0, 2.5)
    assert np.count_nonzero(grid.traversable) <= 2 * MAXIMUM_CELLS
    # Some 0.05 s; many times that means another algorithm.
    assert time.process_time() - begin < 1.0
