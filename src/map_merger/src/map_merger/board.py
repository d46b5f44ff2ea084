"""Cells on an unbounded lattice, and which of its tiles are to be computed anew."""

from typing import Iterator, Set, Tuple

import numpy as np

from mr_grid import UNKNOWN

from .grid import EMPTY_BOX, Box, changed_box, known_cells_box

TILE = 16
"""Edge in cells of a tile."""
CHUNK = 32
"""Edge in tiles of what is computed at once: bounds the memory of a computation."""


class Board:
    """Cells (int8) of a box that grows as it is written to; unknown elsewhere."""

    def __init__(self) -> None:
        self.box = EMPTY_BOX
        self._cells = np.empty((0, 0), np.int8)

    def read(self, box: Box) -> np.ndarray:
        """The cells of the box: a view where all of them are stored, not to be written."""
        if self.box.contains(box) and not box.empty:
            return self._cells[box.shifted(-self.box.top, -self.box.left).slices()]
        result = np.full(box.shape, UNKNOWN, np.int8)
        inside = box.intersection(self.box)
        if not inside.empty:
            result[inside.shifted(-box.top, -box.left).slices()] = self.read(inside)
        return result

    def known_box(self) -> Box:
        """Smallest box around the known cells."""
        return known_cells_box(self._cells).shifted(self.box.top, self.box.left)

    def write(self, box: Box, cells: np.ndarray) -> Box:
        """Replaces the cells of the box; returns the box around those that changed."""
        if box.empty:
            return EMPTY_BOX
        if not self.box.contains(box):
            grown = self.box.union(box.aligned(TILE))
            self._cells, self.box = self.read(grown), grown
        view = self.read(box)
        changed = changed_box(view, cells)
        if changed.empty:
            return EMPTY_BOX
        view[...] = cells
        return changed.shifted(box.top, box.left)


class DirtyTiles:
    """Tiles of an unbounded lattice that are to be computed anew."""

    def __init__(self) -> None:
        self._tiles: Set[Tuple[int, int]] = set()

    def __bool__(self) -> bool:
        return bool(self._tiles)

    def add(self, box: Box, margin: int) -> None:
        """All tiles with cells at most `margin` cells from the box."""
        if not box.empty:
            part = box.grown(margin)
            rows = range(part.top // TILE, -(-part.bottom // TILE))
            columns = range(part.left // TILE, -(-part.right // TILE))
            self._tiles.update((row, column) for row in rows for column in columns)

    def taken(self) -> Iterator[Box]:
        """Boxes, no larger than a chunk, that hold all the tiles; none are left afterwards."""
        tiles, self._tiles = self._tiles, set()
        if not tiles:
            return
        # A small change is computed at once wherever it lies.
        rows, columns = np.array(sorted(tiles)).T
        keys = np.stack([(rows - rows.min()) // CHUNK, (columns - columns.min()) // CHUNK])
        for key in np.unique(keys, axis=1).T:
            inside = (keys == key[:, None]).all(axis=0)
            yield _around(rows[inside], columns[inside])


def _around(rows: np.ndarray, columns: np.ndarray) -> Box:
    """The box around tiles."""
    first, last = (rows.min(), columns.min()), (rows.max() + 1, columns.max() + 1)
    return Box(*(int(number) * TILE for number in (*first, *last)))
