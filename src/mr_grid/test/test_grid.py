"""Occupancy grids: which cell holds which point."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mr_grid import UNKNOWN, GridError, GridInfo, OccupancyGrid, Pose, empty_grid, grid_of, values_at
from mr_grid.grid import MAX_CELLS

METRES = st.floats(-100.0, 100.0)
ORIGINS = st.builds(Pose, METRES, METRES, st.sampled_from([0.0, 0.3, -2.0, math.pi]))
INFOS = st.builds(GridInfo, st.integers(1, 50), st.integers(1, 50), st.floats(0.01, 1.0), ORIGINS)
CELLS = st.lists(st.tuples(st.integers(-60, 60), st.integers(-60, 60)), min_size=1, max_size=8).map(np.array)


@given(INFOS, CELLS)
def test_the_centre_of_a_cell_lies_in_it(info, cells):
    assert np.array_equal(info.cells_of(info.centres_of(cells)), cells)


@given(INFOS, CELLS)
def test_one_cell_and_many_are_told_the_same(info, cells):
    centres = info.centres_of(cells)
    assert [info.cell_of(x, y) for x, y in centres] == [tuple(cell) for cell in cells]
    assert [info.centre_of(row, column) for row, column in cells] == pytest.approx(centres, abs=1e-9)
    assert [info.contains(row, column) for row, column in cells] == info.inside(cells).tolist()


@given(INFOS, CELLS, st.floats(0.01, 0.99), st.floats(0.01, 0.99))
def test_a_place_in_a_cell_is_told_with_its_fraction(info, cells, row, column):
    points = info.centres_of(cells + np.array([row - 0.5, column - 0.5]))
    assert np.stack(info.continuous_cells(points), axis=1) == pytest.approx(cells + np.array([row, column]), abs=1e-6)
    assert np.array_equal(info.cells_of(points), cells)


def test_columns_run_along_x_and_rows_along_y_of_the_turned_origin():
    info = GridInfo(4, 3, 0.5, Pose(10.0, 20.0, math.pi / 2))
    assert info.shape == (3, 4)
    assert info.centre_of(0, 3) == pytest.approx((9.75, 21.75))
    assert info.cell_of(9.75, 21.75) == (0, 3)
    assert info.corners() == pytest.approx(np.array([[10, 20], [10, 22], [8.5, 22], [8.5, 20]]))


def test_points_below_the_corner_have_negative_cells():
    info = GridInfo(2, 2, 0.1)
    assert info.cell_of(-0.01, -0.11) == (-2, -1) and not info.contains(-2, -1)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((2, 2, 0.0), "resolution .* not 0 m"),
        ((2, 2, 1e-300), "resolution"),
        ((2, 2, 1e3), "resolution"),
        ((2, 2, math.nan), "finite"),
        ((2, 2, 0.1, Pose(math.inf)), "finite"),
        ((2, 2, 0.1, Pose(yaw=math.nan)), "finite"),
        ((-1, 2, 0.1), "-1 x 2 cells"),
        ((MAX_CELLS, 2, 0.1), "at most"),
    ],
)
def test_bad_placements_are_refused_with_the_culprit(arguments, words):
    with pytest.raises(GridError, match=words):
        GridInfo(*arguments)


def test_cells_fit_their_placement():
    cells = np.arange(6, dtype=np.int8).reshape(2, 3)
    with pytest.raises(GridError, match=r"6 cells .* says 2 x 3"):
        OccupancyGrid(GridInfo(2, 3, 0.1), cells)
    with pytest.raises(GridError, match="holds 6 cells"):
        grid_of(GridInfo(2, 2, 0.1), cells)
    grid = OccupancyGrid.of(cells, 0.1, Pose(1.0, 2.0))
    assert grid.equals(grid_of(GridInfo(3, 2, 0.1, Pose(1.0, 2.0)), cells.astype(np.int64).ravel()))
    assert (grid.resolution, grid.origin) == (0.1, Pose(1.0, 2.0))


def test_grids_are_equal_in_cells_and_place():
    cells = np.zeros((2, 3), np.int8)
    grid = OccupancyGrid.of(cells, 0.1)
    assert grid.equals(OccupancyGrid.of(cells.copy(), 0.1))
    assert not grid.equals(OccupancyGrid.of(cells, 0.2))
    assert not grid.equals(OccupancyGrid.of(cells, 0.1, Pose(0.1)))
    assert not grid.equals(OccupancyGrid.of(cells + np.int8(1), 0.1))


@given(INFOS, st.integers(0, 2**32 - 1), st.lists(st.tuples(METRES, METRES), max_size=20))
def test_values_are_those_of_the_cell_that_holds_the_point(info, seed, places):
    points = np.array(places).reshape(-1, 2)
    cells = np.random.default_rng(seed).integers(-1, 101, info.shape).astype(np.int8)
    grid = OccupancyGrid(info, cells)
    expected = [
        cells[row, column] if info.contains(row, column) else UNKNOWN for row, column in info.cells_of(points).tolist()
    ]
    assert grid.values_at(points).tolist() == expected
    assert values_at(cells > 50, info, points, True).dtype == bool


def test_what_was_never_seen_is_unknown():
    grid = empty_grid(GridInfo(3, 2, 0.1))
    assert grid.unknown.all() and grid.unknown.shape == (2, 3)
    nothing = empty_grid(GridInfo(0, 0, 0.1))
    assert nothing.values_at(np.zeros((2, 2))).tolist() == [UNKNOWN] * 2
