"""A robot's map as drawn on the own lattice."""

from typing import Optional, Tuple

import numpy as np

from mr_grid import UNKNOWN, GridInfo, OccupancyGrid, Pose

from .board import Board
from .drawing import box_of, drawn, nearly, whole_shift
from .grid import EMPTY_BOX, Box, changed_box, full_box, known_box


class Layer:
    """One foreign map. Cells count from the corner of the lattice."""

    def __init__(self) -> None:
        self.board = Board()
        self.box = EMPTY_BOX
        """Around the known cells."""
        self.too_large = False
        """It would take more cells than allowed, and is not drawn."""
        self._source: Optional[OccupancyGrid] = None
        self._transform = Pose()
        self._version: object = None

    def follows(self, version: object, transform: Pose) -> bool:
        """True if the map of this version is drawn already, nearly where the transform lays it."""
        return self._source is not None and version == self._version and nearly(transform, self._transform)

    def set(
        self, source: OccupancyGrid, version: object, transform: Pose, changed: Optional[Box], lattice: GridInfo,
        most: int,
    ) -> Box:  # fmt: skip
        """Draws what changed, `most` cells in all; returns the box of the cells that became others. `changed` counts
        from the source's corner; None: any cell may have changed."""
        part = self._changed_part(source, transform, changed)
        self._source, self._version = source, version
        if part is None or self.too_large or self._size(transform, lattice) > most:
            self._transform = transform
            return self._redrawn(lattice, most)
        return self._draw(part, lattice)

    def _redrawn(self, lattice: GridInfo, most: int) -> Box:
        """Draws everything; returns the box of the cells that became others."""
        before = self.board
        self.draw_anew(lattice, most)
        box = before.box.union(self.board.box)
        return changed_box(before.read(box), self.board.read(box)).shifted(box.top, box.left)

    def draw_anew(self, lattice: GridInfo, most: int) -> None:
        """Draws everything, `most` cells in all, on a lattice that has nothing to do with the one before."""
        assert self._source is not None
        self.board, self.box = Board(), EMPTY_BOX
        self.too_large = self._size(self._transform, lattice) > most
        if not self.too_large:
            self._draw(known_box(self._source), lattice)

    def _size(self, transform: Pose, lattice: GridInfo) -> int:
        """Cells of the lattice that the known part takes at most."""
        assert self._source is not None
        return box_of(self._source.info, full_box(self._source.info), transform, lattice).area

    def _changed_part(self, source: OccupancyGrid, transform: Pose, changed: Optional[Box]) -> Optional[Box]:
        """Cells of the new source that may differ from the former one; None if it is another lattice or transform."""
        if self._source is None or not nearly(transform, self._transform):
            return None
        shift = whole_shift(self._source.info, source.info)
        if shift is None:
            return None
        return difference(self._source, source, shift) if changed is None else changed

    def _draw(self, part: Box, lattice: GridInfo) -> Box:
        if part.empty:
            return EMPTY_BOX
        assert self._source is not None
        # Links of walls depend on the cells beside them.
        box = box_of(self._source.info, part.grown(1), self._transform, lattice)
        near = box_of(lattice, box, self._transform.inverse(), self._source.info).grown(1)
        near = near.intersection(full_box(self._source.info))
        changed = self.board.write(box, drawn(self._source, near, self._transform, lattice, box))
        if not changed.empty:
            self.box = self.board.known_box()
        return changed


def difference(before: OccupancyGrid, after: OccupancyGrid, shift: Tuple[int, int]) -> Box:
    """Box around the cells of `after` that differ from `before`, whose first cell lies at `shift` of it."""
    if before is after:
        return EMPTY_BOX
    old, new = full_box(before.info).shifted(*shift), full_box(after.info)
    if old == new:
        return changed_box(before.cells, after.cells)
    both = old.union(new)
    first, second = np.full(both.shape, UNKNOWN, np.int8), np.full(both.shape, UNKNOWN, np.int8)
    first[old.shifted(-both.top, -both.left).slices()] = before.cells
    second[new.shifted(-both.top, -both.left).slices()] = after.cells
    return changed_box(first, second).shifted(both.top, both.left)
