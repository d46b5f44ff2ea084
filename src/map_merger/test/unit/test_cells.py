"""Boxes around cells, and writing into maps: the compiled code against plain numpy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from map_merger import _surfaces
from map_merger.grid import EMPTY_BOX, Box, bounding_box, changed_box, known_cells_box
from map_merger.places import blocks
from mr_grid import UNKNOWN

SHAPES = st.tuples(st.integers(0, 5), st.integers(0, 20))
CELLS = st.sampled_from([-1, 0, 100])


def maps(count=1):
    return SHAPES.flatmap(lambda shape: st.tuples(*[arrays.arrays(np.int8, shape, elements=CELLS)] * count))


def box_around(mask):
    rows, columns = np.nonzero(mask)
    return Box(rows.min(), columns.min(), rows.max() + 1, columns.max() + 1) if rows.size else EMPTY_BOX


@given(maps(2))
def test_boxes_are_the_smallest_around_what_counts(pair):
    before, after = pair
    assert changed_box(before, after) == box_around(before != after)
    assert known_cells_box(after) == box_around(after != UNKNOWN)
    assert bounding_box(after == 100) == box_around(after == 100)


@given(maps())
def test_boxes_of_views_are_those_of_their_cells(single):
    view = np.repeat(single[0], 2, axis=1)[:, ::2]
    assert known_cells_box(view) == box_around(view != UNKNOWN)


def test_maps_of_different_shapes_cannot_be_compared():
    with pytest.raises(ValueError, match="one shape"):
        changed_box(np.zeros((2, 3), np.int8), np.zeros((3, 2), np.int8))


@given(maps(2), st.booleans(), st.data())
def test_cells_are_written_unless_newer_ones_are_there(pair, known_only, data):
    store, cells = pair
    stamps = data.draw(arrays.arrays(np.int32, store.shape, elements=st.integers(0, 4)))
    written = (stamps <= 2) & ((cells != UNKNOWN) | (not known_only))
    expected, changed = np.where(written, cells, store), box_around(written & (cells != store))
    expected_stamps = np.where(written, 2, stamps)
    assert Box(*_surfaces.write_cells(store, stamps, 0, 0, cells, 2, known_only)) == changed
    assert (store == expected).all() and (stamps == expected_stamps).all()


def test_cells_beyond_the_store_are_refused():
    with pytest.raises(ValueError, match="in the store"):
        _surfaces.write_cells(np.zeros((4, 4), np.int8), None, 2, 0, np.zeros((3, 3), np.int8), 0, False)


@given(st.lists(st.tuples(st.integers(0, 11), st.integers(0, 30)), max_size=4), st.floats(0.0, 6.0))
def test_discs_are_those_of_their_radius(places, radius):
    centres = np.array(places, np.int64).reshape(-1, 2)
    rows, columns = np.indices((12, 31))
    apart = [np.hypot(rows - row, columns - column) > radius for row, column in places]
    left = _surfaces.without_discs(np.ones((12, 31), bool), centres, radius)
    assert (left == np.logical_and.reduce(apart, initial=True) if places else left.all()).all()


@given(st.lists(st.tuples(st.integers(-80, 80), st.integers(-80, 80)), max_size=20))
def test_blocks_hold_all_cells_and_nothing_around_them(places):
    cells = np.array(places, np.int64).reshape(-1, 2)
    boxes = blocks(cells)
    groups = {(row // 32, column // 32) for row, column in places}
    assert len(boxes) == len(groups)
    for box in boxes:
        inside = cells[(cells[:, 0] // 32 == box.top // 32) & (cells[:, 1] // 32 == box.left // 32)]
        assert box == Box(*inside.min(axis=0), *(inside.max(axis=0) + 1))
