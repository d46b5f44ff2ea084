"""A map on an unbounded lattice, to be written in pieces."""

from dataclasses import replace

import numpy as np

from mr_grid import UNKNOWN, GridError, GridInfo, OccupancyGrid

from .._surfaces import write_cells
from ..grid import EMPTY_BOX, Box, known_cells_box, window

BLOCK = 64
"""The store grows by whole blocks of this edge, so that a growing map is not copied for every new row."""


class Canvas:
    """A map on an unbounded lattice: cells are written at any offset from the anchor's corner.

    A stamped canvas also remembers with which stamp each cell was written, and leaves newer cells alone.
    """

    def __init__(self, anchor: GridInfo, stamped: bool = False) -> None:
        self.anchor = replace(anchor, width=0, height=0)
        self._box = EMPTY_BOX
        self._cells = np.empty((0, 0), np.int8)
        self._stamps = np.empty((0, 0), np.int32) if stamped else None

    @property
    def stored(self) -> int:
        """Number of cells that take memory."""
        return self._box.area

    def write(self, top: int, left: int, cells: np.ndarray, most: int, stamp: int = 0) -> Box:
        """Writes all cells at the offset, the unknown ones too; returns the box of cells whose value changed.

        GridError if more than `most` cells would be stored.
        """
        return self._write(Box(top, left, top + cells.shape[0], left + cells.shape[1]), cells, False, most, stamp)

    def write_known(self, top: int, left: int, cells: np.ndarray, most: int, stamp: int = 0) -> Box:
        """As `write`, but the unknown cells say nothing."""
        known = known_cells_box(cells)
        return self._write(known.shifted(top, left), cells[known.slices()], True, most, stamp)

    def read(self, box: Box) -> np.ndarray:
        """Copy of the cells of the box, unknown where nothing was written."""
        result = np.full(box.shape, UNKNOWN, np.int8)
        inside = box.intersection(self._box)
        if not inside.empty:
            result[inside.shifted(-box.top, -box.left).slices()] = self._cells[self._place(inside)]
        return result

    def known_box(self) -> Box:
        """Smallest box around the known cells."""
        box = known_cells_box(self._cells)
        return box if box.empty else box.shifted(self._box.top, self._box.left)

    def grid(self) -> OccupancyGrid:
        """Snapshot of the known part."""
        box = self.known_box()
        return OccupancyGrid(window(self.anchor, box), self.read(box))

    def _write(self, target: Box, cells: np.ndarray, known_only: bool, most: int, stamp: int) -> Box:
        if target.empty:
            return EMPTY_BOX
        self._reserve(target, most)
        place = target.shifted(-self._box.top, -self._box.left)
        changed = Box(*write_cells(self._cells, self._stamps, place.top, place.left, cells, stamp, known_only))
        return changed if changed.empty else changed.shifted(self._box.top, self._box.left)

    def _place(self, box: Box) -> tuple:
        return box.shifted(-self._box.top, -self._box.left).slices()

    def _reserve(self, target: Box, most: int) -> None:
        if self._box.contains(target):
            return
        box = self._box.union(target.aligned(BLOCK))
        if box.area > most:
            rows, columns = box.shape
            raise GridError(
                f"a tile at row {target.top}, column {target.left} would make the map {columns} x {rows} cells, and "
                f"there is room for {most}"
            )
        self._cells = self._moved(self._cells, box, UNKNOWN)
        if self._stamps is not None:
            self._stamps = self._moved(self._stamps, box, 0)
        self._box = box

    def _moved(self, store: np.ndarray, box: Box, filler: int) -> np.ndarray:
        result = np.full(box.shape, filler, store.dtype)
        if not self._box.empty:
            result[self._box.shifted(-box.top, -box.left).slices()] = store
        return result
