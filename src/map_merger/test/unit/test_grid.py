"""Geometry: cells, metres, boxes and the growing canvas."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from map_merger.grid import (
    EMPTY_BOX,
    MAX_CELLS,
    UNKNOWN,
    Box,
    Grid,
    GridError,
    GridInfo,
    bounding_box,
    cell_centres,
    cells_of,
    cropped,
    full_box,
    grid_of,
    offset_between,
    window,
)
from map_merger.transform import displacement, rotation_between
from mr_grid import Pose, normalized, pose_of

angles = st.floats(-10.0, 10.0)
metres = st.floats(-100.0, 100.0)
transforms = st.builds(Pose, metres, metres, angles)
infos = st.builds(GridInfo, st.integers(1, 60), st.integers(1, 60), st.floats(0.01, 1.0), transforms)
offsets = st.integers(-80, 80)
boxes = st.builds(
    lambda top, left, rows, columns: Box(top, left, top + rows, left + columns),
    offsets,
    offsets,
    st.integers(1, 30),
    st.integers(1, 30),
)


@given(transforms, transforms, metres, metres)
def test_compose_applies_the_second_first(first, second, x, y):
    direct = first.apply_point(*second.apply_point(x, y))
    assert np.allclose(first.compose(second).apply_point(x, y), direct, atol=1e-6)


@given(transforms)
def test_inverse_undoes(transform):
    undone = transform.compose(transform.inverse())
    assert math.hypot(undone.x, undone.y) < 1e-6
    assert abs(undone.yaw) < 1e-9


def test_half_a_turn_is_normalized():
    assert normalized(-math.pi) == math.pi
    assert normalized(3.0 * math.pi) == pytest.approx(math.pi)
    assert rotation_between(Pose(yaw=3.1), Pose(yaw=-3.1)) == pytest.approx(2 * math.pi - 6.2)


def test_displacement_of_a_pure_turn_grows_with_the_distance():
    assert displacement(Pose(), Pose(yaw=0.1), np.array([[0.0, 0.0], [10.0, 0.0]])) == pytest.approx(
        [0.0, 20.0 * math.sin(0.05)]
    )


@pytest.mark.parametrize("bad", [[1, 2], [1, 2, 3, 4], [1, 2, math.nan], ["a", 1, 2]])
def test_a_pose_needs_three_finite_numbers(bad):
    with pytest.raises(ValueError):
        pose_of(bad)


@given(infos, st.data())
def test_the_centre_of_a_cell_is_in_that_cell(info, data):
    row = data.draw(st.integers(-5, info.height + 5))
    column = data.draw(st.integers(-5, info.width + 5))
    rows, columns, inside = cells_of(info, cell_centres(info, np.array([row]), np.array([column])))
    assert (rows[0], columns[0]) == (row, column)
    assert inside[0] == (0 <= row < info.height and 0 <= column < info.width)


@given(infos, boxes)
def test_a_window_lies_where_its_offset_says(info, box):
    assert offset_between(window(info, box), info) == (box.top, box.left)


def test_other_resolution_or_heading_is_refused():
    info = GridInfo(4, 4, 0.05)
    with pytest.raises(GridError, match="resolution"):
        offset_between(GridInfo(4, 4, 0.1), info)
    with pytest.raises(GridError, match="heading"):
        offset_between(GridInfo(4, 4, 0.05, Pose(0, 0, 0.1)), info)


@pytest.mark.parametrize(
    "width, height, resolution",
    [
        (1, 1, 0.0),
        (1, 1, -1.0),
        (1, 1, 1e-9),
        (1, 1, 1e300),
        (1, 1, math.nan),
        (-1, 1, 1.0),
        (MAX_CELLS, 2, 1.0),
    ],
)
def test_impossible_grids_are_refused(width, height, resolution):
    with pytest.raises(GridError):
        GridInfo(width, height, resolution)


def test_data_must_fit_the_geometry():
    with pytest.raises(GridError, match="3 values"):
        grid_of(GridInfo(2, 2, 0.05), np.zeros(3, np.int8))


@given(boxes, boxes)
def test_union_and_intersection(first, second):
    assert first.union(second).contains(first) and first.union(second).contains(second)
    assert first.contains(first.intersection(second)) and second.contains(first.intersection(second))
    assert first.union(EMPTY_BOX) == first


@given(boxes, st.integers(1, 12))
def test_tiles_cover_the_box_once(box, size):
    count = np.zeros((200, 200), int)
    for tile in box.tiles(size):
        assert max(tile.shape) <= size
        count[tile.shifted(90, 90).slices()] += 1
    assert (count[box.shifted(90, 90).slices()] == 1).all() and count.sum() == np.prod(box.shape)


@given(boxes, st.integers(1, 40))
def test_aligned_boxes_hold_the_box_and_consist_of_blocks(box, block):
    aligned = box.aligned(block)
    assert aligned.contains(box)
    assert all(value % block == 0 for value in (aligned.top, aligned.left, aligned.bottom, aligned.right))


def test_bounding_box_of_nothing_is_empty():
    assert bounding_box(np.zeros((4, 5), bool)).empty
    assert bounding_box(np.zeros((0, 0), bool)).empty


@given(boxes)
def test_cropping_keeps_the_cells_in_place(box):
    cells = np.arange(100, dtype=np.int8).reshape(10, 10)
    grid = Grid(GridInfo(10, 10, 0.1, Pose(1.0, 2.0, 0.3)), cells)
    part = cropped(grid, box)
    assert offset_between(part.info, grid.info) == (box.top, box.left)
    for row, column in ((0, 0), (3, 7), (9, 9)):
        if box.contains(Box(row, column, row + 1, column + 1)):
            assert part.cells[row - box.top, column - box.left] == cells[row, column]
    assert (part.cells != UNKNOWN).sum() == np.prod(box.intersection(full_box(grid.info)).shape)
