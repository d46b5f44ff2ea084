"""Geometry: cells, metres, boxes and the growing canvas."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from map_merger.grid import EMPTY_BOX, Box, bounding_box, cropped, full_box, offset_between, window
from map_merger.transform import displacement, rotation_between
from mr_grid import UNKNOWN, GridError, GridInfo, OccupancyGrid, Pose

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


def test_rotation_between_goes_the_shorter_way():
    assert rotation_between(Pose(yaw=3.1), Pose(yaw=-3.1)) == pytest.approx(2 * math.pi - 6.2)


def test_displacement_of_a_pure_turn_grows_with_the_distance():
    assert displacement(Pose(), Pose(yaw=0.1), np.array([[0.0, 0.0], [10.0, 0.0]])) == pytest.approx(
        [0.0, 20.0 * math.sin(0.05)]
    )


@given(infos, boxes)
def test_a_window_lies_where_its_offset_says(info, box):
    assert offset_between(window(info, box), info) == (box.top, box.left)


def test_other_resolution_or_heading_is_refused():
    info = GridInfo(4, 4, 0.05)
    with pytest.raises(GridError, match="resolution"):
        offset_between(GridInfo(4, 4, 0.1), info)
    with pytest.raises(GridError, match="heading"):
        offset_between(GridInfo(4, 4, 0.05, Pose(0, 0, 0.1)), info)


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
    grid = OccupancyGrid(GridInfo(10, 10, 0.1, Pose(1.0, 2.0, 0.3)), cells)
    part = cropped(grid, box)
    assert offset_between(part.info, grid.info) == (box.top, box.left)
    for row, column in ((0, 0), (3, 7), (9, 9)):
        if box.contains(Box(row, column, row + 1, column + 1)):
            assert part.cells[row - box.top, column - box.left] == cells[row, column]
    assert (part.cells != UNKNOWN).sum() == np.prod(box.intersection(full_box(grid.info)).shape)
