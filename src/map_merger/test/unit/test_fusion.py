"""Fusion: the local map is kept, walls stay closed and thin, doors stay open."""

import math

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from map_merger.fusion import Layer, fitting, fused, resampled, without_robots
from map_merger.grid import FREE, OCCUPIED, UNKNOWN, Box, Grid, GridInfo, offset_between
from map_merger.transform import Transform


def room(rows=40, columns=60, x=0.0, y=0.0, yaw=0.0):
    """Free space inside a wall one cell thick."""
    cells = np.zeros((rows, columns), np.int8)
    cells[[0, -1]] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    return Grid(GridInfo(columns, rows, 0.05, Transform(x, y, yaw)), cells)


def unknown(rows=80, columns=100, x=-1.0, y=-1.0):
    return Grid(GridInfo(columns, rows, 0.05, Transform(x, y, 0.0)), np.full((rows, columns), UNKNOWN, np.int8))


def reaches(grid, begin, end):
    """True if the free cell `end` can be reached from `begin` by steps to the four neighbours."""
    _, labels = cv2.connectedComponents(grid.free.astype(np.uint8), connectivity=4)
    return labels[begin] != 0 and labels[begin] == labels[end]


def cell_of(grid, x, y):
    local = grid.info.origin.inverse().apply_point(x, y)
    return math.floor(local[1] / grid.info.resolution), math.floor(local[0] / grid.info.resolution)


def merge(local, *others):
    layers = [resampled(grid, transform, local) for grid, transform in others]
    return fused(local, [layer for layer in layers if layer is not None])


def test_alone_it_is_the_local_map_itself():
    local = room()
    assert fused(local, []) is local


def test_a_map_that_knows_nothing_changes_nothing():
    local = room()
    assert merge(local, (unknown(), Transform())) is local


@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-math.pi, math.pi))
def test_local_cells_are_kept_and_the_lattice_is_that_of_the_local_map(x, y, yaw):
    local = room(x=-0.3, y=0.7)
    merged = merge(local, (room(), Transform(x, y, yaw)))
    row, column = offset_between(local.info, merged.info)
    part = merged.cells[row : row + local.info.height, column : column + local.info.width]
    assert np.array_equal(part, local.cells)
    assert merged.info.resolution == local.info.resolution
    shift = merged.info.origin.inverse().compose(local.info.origin)
    assert shift.x / 0.05 == pytest.approx(round(shift.x / 0.05), abs=1e-6)


@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-math.pi, math.pi))
def test_foreign_walls_stay_closed_and_thin_at_any_angle(x, y, yaw):
    local = unknown(200, 200, -5.0, -5.0)
    foreign = room()
    transform = Transform(x, y, yaw)
    merged = merge(local, (foreign, transform))
    inside = cell_of(merged, *transform.apply_point(1.5, 1.0))
    padded = Grid(
        GridInfo(merged.info.width, merged.info.height, 0.05),
        np.where(merged.cells == UNKNOWN, FREE, merged.cells).astype(np.int8),
    )
    assert not reaches(padded, inside, (0, 0)), "the wall has a gap"
    assert merged.occupied.sum() <= 1.25 * foreign.occupied.sum(), "the wall became thicker"


@given(st.floats(0.0, math.pi / 2))
def test_walls_that_hang_together_at_corners_only_stay_closed(yaw):
    cells = np.full((41, 41), UNKNOWN, np.int8)
    rows, columns = np.mgrid[0:41, 0:41]
    distance = abs(rows - 20) + abs(columns - 20)
    cells[distance < 15] = FREE
    cells[distance == 15] = OCCUPIED
    transform = Transform(0.013, -0.007, yaw)
    merged = merge(unknown(200, 200, -5.0, -5.0), (Grid(GridInfo(41, 41, 0.05), cells), transform))
    padded = Grid(
        GridInfo(merged.info.width, merged.info.height, 0.05),
        np.where(merged.cells == UNKNOWN, FREE, merged.cells).astype(np.int8),
    )
    assert not reaches(padded, cell_of(merged, *transform.apply_point(1.0, 1.0)), (0, 0))


def test_without_shift_the_copy_is_exact_at_another_resolution_of_origin():
    local = unknown(100, 100, -1.0, -1.0)
    merged = merge(local, (room(), Transform()))
    assert np.array_equal(merged.cells[20:60, 20:80], room().cells)


@pytest.mark.parametrize("shift", [-0.05, 0.05, 0.08, -0.08])
def test_a_door_that_the_robot_saw_is_not_closed_by_a_wall_one_cell_off(shift):
    local = room(40, 60)
    local.cells[0, 25:45] = FREE
    foreign = Grid(GridInfo(60, 35, 0.05, Transform(0.0, -1.45, 0.0)), np.zeros((35, 60), np.int8))
    foreign.cells[29] = OCCUPIED
    foreign.cells[29, 25:45] = FREE
    merged = merge(local, (foreign, Transform(shift, shift, 0.0)))
    row, column = offset_between(local.info, merged.info)
    assert reaches(merged, (row + 20, column + 30), (row - 10, column + 30))


@pytest.mark.parametrize("shift", [0.05, -0.05])
def test_a_wall_that_falls_on_local_floor_does_not_open(shift):
    """The local map saw the floor up to the wall but not the wall; the foreign wall is one cell off."""
    local = room(40, 60)
    local.cells[-1] = UNKNOWN
    foreign = Grid(GridInfo(60, 30, 0.05, Transform(0.0, 1.95, 0.0)), np.zeros((30, 60), np.int8))
    foreign.cells[0] = OCCUPIED
    merged = merge(local, (foreign, Transform(0.0, shift, 0.0)))
    row, column = offset_between(local.info, merged.info)
    assert not reaches(merged, (row + 20, column + 30), (row + 55, column + 30))


def test_layers_with_which_the_map_would_be_too_large_are_left_out():
    local, near = room(), Layer(Box(0, 100, 40, 160), np.zeros((40, 60), np.int8))
    far = Layer(Box(4000, 4000, 4001, 4001), np.zeros((1, 1), np.int8))
    assert fitting(local, [far, near]) == [near]
    assert fused(local, [far, near]).info.width == 160
    assert resampled(room(400, 600), Transform(), room()) is not None
    assert resampled(room(400, 600), Transform(), Grid(GridInfo(9, 9, 0.001), np.zeros((9, 9), np.int8))) is None


def test_earlier_layers_win_over_later_ones():
    local = unknown()
    wall = Grid(GridInfo(4, 4, 0.05), np.full((4, 4), OCCUPIED, np.int8))
    floor = Grid(GridInfo(4, 4, 0.05), np.zeros((4, 4), np.int8))
    assert merge(local, (wall, Transform()), (floor, Transform())).cells.max() == OCCUPIED
    assert merge(local, (floor, Transform()), (wall, Transform())).cells.max() == FREE


def test_smudges_of_robots_are_dropped_and_walls_are_not():
    grid = room()
    grid.cells[18:26, 20:27] = OCCUPIED
    grid.cells[1:4, 40] = OCCUPIED
    cleaned = without_robots(grid, np.array([[1.2, 1.1], [2.0, 0.15]]))
    assert (cleaned.cells[18:26, 20:27] == FREE).all()
    assert (cleaned.cells[1:4, 40] == OCCUPIED).all(), "what is joined to a wall stays"
    assert cleaned.cells[0].min() == OCCUPIED
    assert without_robots(grid, np.empty((0, 2))) is grid
    assert np.array_equal(without_robots(grid, np.array([[2.6, 1.6]])).cells, grid.cells)


def test_other_resolutions_are_resampled():
    coarse = Grid(GridInfo(10, 10, 0.1), np.full((10, 10), FREE, np.int8))
    coarse.cells[:, 0] = OCCUPIED
    merged = merge(unknown(), (coarse, Transform()))
    assert (merged.cells == OCCUPIED).sum() == 2 * 20
    assert (merged.cells == FREE).sum() == 18 * 20
