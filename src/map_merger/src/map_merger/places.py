"""Where a robot has been, on a lattice."""

from typing import List

import numpy as np

from mr_grid import GridInfo

from .grid import Box

MOST_PLACES = 4000
"""Places of one robot that count; more are thinned out."""
_THINNED_M = 0.2
"""Places of a track that is thinned out are at least about so far apart."""
SAME_PLACE_M = 0.02
"""Places that moved by less, as a transform is refined, stay where they are."""
_BLOCK = 32
"""Edge in cells of the blocks in which changes are told."""


class Places:
    """The places of one robot; `cells`: row and column on the lattice, int64 (n, 2), oldest first."""

    def __init__(self) -> None:
        self.points = np.empty((0, 2))
        self.cells = np.empty((0, 2), np.int64)

    def set(self, points: np.ndarray, lattice: GridInfo) -> np.ndarray:
        """Points (n, 2) in m, own frame, oldest first; returns the cells, (m, 2), that came or went.
        ValueError for another shape or what is no number."""
        points = np.array(points, float)
        if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
            raise ValueError(f"places are finite numbers of shape (n, 2), not {points.shape}")
        if len(points) > MOST_PLACES:
            points = points[thinned(points, MOST_PLACES, _THINNED_M)]
        same = self._same(points)
        points[:same] = self.points[:same]
        before = self.cells
        self.points = points
        self.draw(lattice)
        return np.concatenate([before[same:], self.cells[same:]])

    def draw(self, lattice: GridInfo) -> None:
        """The lattice is another one."""
        self.cells = np.floor(np.stack(lattice.continuous_cells(self.points), axis=1)).astype(np.int64)

    def _same(self, points: np.ndarray) -> int:
        """How many of the first points are those of before."""
        common = min(len(points), len(self.points))
        moved = np.hypot(*(points[:common] - self.points[:common]).T) > SAME_PLACE_M
        return int(np.argmax(moved)) if moved.any() else common


def thinned(points: np.ndarray, most: int, square: float) -> np.ndarray:
    """Which of the points (n, 2) to keep, in their order: the last one in each square of so many metres or, if those
    are more than `most`, in each of the smallest larger ones."""
    while True:
        squares = np.floor(points / square).astype(np.int64)
        _, last = np.unique(squares[::-1], axis=0, return_index=True)
        if len(last) <= most:
            return np.sort(len(points) - 1 - last)
        square *= 2.0


def blocks(cells: np.ndarray) -> List[Box]:
    """Boxes around all the cells (n, 2), one for those of each block."""
    if not len(cells):
        return []
    numbers = cells // _BLOCK
    order = np.lexsort((numbers[:, 1], numbers[:, 0]))
    cells, numbers = cells[order], numbers[order]
    starts = np.flatnonzero(np.append(True, (numbers[1:] != numbers[:-1]).any(axis=1)))
    first, last = np.minimum.reduceat(cells, starts), np.maximum.reduceat(cells, starts) + 1
    return [Box(*corner, *end) for corner, end in zip(first.tolist(), last.tolist())]
