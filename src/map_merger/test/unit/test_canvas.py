"""Canvas: maps written in pieces, with stamps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from map_merger.exchange.canvas import Canvas
from map_merger.grid import Box, bounding_box
from mr_grid import UNKNOWN, GridError, GridInfo
from mr_grid.grid import MAX_CELLS

boxes = st.builds(
    lambda top, left, rows, columns: Box(top, left, top + rows, left + columns),
    *[st.integers(-90, 90)] * 2,
    *[st.integers(1, 40)] * 2,
)


@given(st.lists(st.tuples(boxes, st.integers(0, 100)), min_size=1, max_size=6))
def test_canvas_remembers_what_was_written_at_any_offset(writes):
    canvas = Canvas(GridInfo(0, 0, 0.05))
    reference = np.full((300, 300), UNKNOWN, np.int8)
    for box, value in writes:
        changed = canvas.write_known(box.top, box.left, np.full(box.shape, value, np.int8), MAX_CELLS)
        view = reference[box.shifted(150, 150).slices()]
        assert changed.empty == bool((view == value).all())
        view[:] = value
    whole = Box(-150, -150, 150, 150)
    assert np.array_equal(canvas.read(whole), reference)
    assert canvas.known_box() == bounding_box(reference != UNKNOWN).shifted(-150, -150)


def test_canvas_skips_unknown_cells_and_refuses_absurd_offsets():
    canvas = Canvas(GridInfo(0, 0, 0.05))
    canvas.write_known(0, 0, np.array([[5, -1]], np.int8), MAX_CELLS)
    assert canvas.write_known(0, 0, np.array([[-1, -1]], np.int8), MAX_CELLS).empty
    assert canvas.read(Box(0, 0, 1, 2)).tolist() == [[5, -1]]
    with pytest.raises(GridError, match="row 2000000"):
        canvas.write_known(2000000, 2000000, np.zeros((1, 1), np.int8), MAX_CELLS)
    assert canvas.stored == 64 * 64
    with pytest.raises(GridError, match="room for 8000"):
        canvas.write_known(0, 64, np.zeros((1, 1), np.int8), 8000)


def test_unknown_cells_erase_unless_what_is_there_is_newer():
    canvas = Canvas(GridInfo(0, 0, 0.05), stamped=True)
    canvas.write(0, 0, np.array([[1, 2, 3]], np.int8), MAX_CELLS, 5)
    canvas.write(0, 1, np.array([[7]], np.int8), MAX_CELLS, 9)
    assert canvas.write(0, 0, np.full((1, 3), UNKNOWN, np.int8), MAX_CELLS, 6) == Box(0, 0, 1, 3)
    assert canvas.read(Box(0, 0, 1, 3)).tolist() == [[-1, 7, -1]]


def test_a_cell_that_was_erased_before_it_was_ever_known_stays_so_when_its_old_value_comes_late():
    canvas = Canvas(GridInfo(0, 0, 0.05), stamped=True)
    canvas.write(0, 0, np.array([[UNKNOWN]], np.int8), MAX_CELLS, 6)
    assert canvas.write(0, 0, np.array([[100]], np.int8), MAX_CELLS, 5).empty
    assert canvas.known_box().empty
