"""What came into the robot's own map where it had shown free ground: things that move, not walls."""

from typing import Dict, Optional, Tuple

import numpy as np

from mr_grid import OccupancyGrid
from mr_grid.imaging import dilated, parts_of
from mr_robot.navigation.options import REACH

Cell = Tuple[int, int]
"""(row, column) on the lattice of all maps, counted from its zero."""


class Arrivals:
    """Knows such cells and takes them out of maps. SLAM draws a robot that stands in a corridor as a wall across it."""

    def __init__(self, settles: float) -> None:
        """`settles`: s after which what has come and stands is a wall."""
        self._settles = settles
        self._before: Optional[OccupancyGrid] = None
        self._since: Dict[Cell, float] = {}
        self._came, self._came_at = np.empty((0, 2), np.int64), np.empty(0)  # the same as arrays
        # A map, which of the cells were taken out of it, and what was left.
        self._taken: Optional[Tuple[OccupancyGrid, np.ndarray, OccupancyGrid]] = None

    def update(self, own: OccupancyGrid, now: float) -> None:
        """`own`: the robot's latest own map."""
        before, offset = self._before, _cells_of(own)
        if before is None or before.resolution != own.resolution or offset is None:
            self._keep(None if offset is None else own, {})
            return
        for row, column in self._new_cells(before, own):
            self._since.setdefault((row + offset[0], column + offset[1]), now)
        rows, columns = own.cells.shape
        cells, kept = own.cells.copy(), {}
        for cell, since in self._since.items():
            row, column = cell[0] - offset[0], cell[1] - offset[1]
            inside = 0 <= row < rows and 0 <= column < columns
            if inside and cells[row, column] > 50 and now - since < self._settles:
                cells[row, column] = 0
                kept[cell] = since
        self._keep(OccupancyGrid(own.info, cells), kept)

    def _keep(self, settled: Optional[OccupancyGrid], since: Dict[Cell, float]) -> None:
        self._before, self._since = settled, since
        self._came = np.array(list(since), np.int64).reshape(-1, 2)
        self._came_at = np.array(list(since.values()), float)
        self._taken = None

    @property
    def settled(self) -> Optional[OccupancyGrid]:
        """The robot's latest own map with free cells in place of what has come lately."""
        return self._before

    def taken_from(self, grid: OccupancyGrid, now: float) -> OccupancyGrid:
        """A map with free cells in place of what has come lately; itself where it shows nothing of it."""
        lately = now - self._came_at < self._settles
        if self._taken is None or self._taken[0] is not grid or not np.array_equal(self._taken[1], lately):
            self._taken = (grid, lately, self._without(grid, self._came[lately]))
        return self._taken[2]

    def _without(self, grid: OccupancyGrid, present: np.ndarray) -> OccupancyGrid:
        offset = _cells_of(grid)
        if offset is None or self._before is None or self._before.resolution != grid.resolution or not len(present):
            return grid
        places = present - offset
        rows, columns = places[grid.info.inside(places)].T
        walls = grid.cells[rows, columns] > 0
        if not walls.any():
            return grid
        cells = grid.cells.copy()
        cells[rows[walls], columns[walls]] = 0
        return OccupancyGrid(grid.info, cells)

    @staticmethod
    def _new_cells(before: OccupancyGrid, after: OccupancyGrid) -> np.ndarray:
        """Cells (n, 2) of `after` that are walls where there were none near."""
        first, second = _cells_of(before), _cells_of(after)
        assert first is not None and second is not None
        low = np.maximum(first, second)
        high = np.minimum(np.add(first, before.cells.shape), np.add(second, after.cells.shape))
        if (high <= low).any():
            return np.empty((0, 2), int)
        (top, left), (a, b) = low - first, low - second
        height, width = high - low
        old = before.cells[top : top + height, left : left + width]
        came = (after.cells[a : a + height, b : b + width] > 50) & (old >= 0) & (old <= 50)
        if not came.any():
            return np.empty((0, 2), int)
        part = _around(came)
        came, old = came[part], old[part]
        # Beside a wall it is that wall, seen better.
        came &= ~dilated(old > 50, 3)
        # What is larger came because SLAM draws its map elsewhere.
        small = np.argwhere(_small(came, round(REACH / after.resolution)))
        return np.add(small, (a + part[0].start, b + part[1].start))


def _around(cells: np.ndarray) -> Tuple[slice, slice]:
    """The window of the cells, bool (rows, columns), and of those beside them."""
    rows, columns = cells.any(axis=1).nonzero()[0], cells.any(axis=0).nonzero()[0]
    return slice(max(0, rows[0] - 1), rows[-1] + 2), slice(max(0, columns[0] - 1), columns[-1] + 2)


def _small(cells: np.ndarray, most: int) -> np.ndarray:
    """Those of the cells, bool (rows, columns), that hang together in no more than `most` rows and columns."""
    parts = parts_of(cells)
    return cells & (parts.extents() <= most)[parts.labels]


def _cells_of(grid: OccupancyGrid) -> Optional[Cell]:
    """Where the corner of the grid lies on the lattice; None if on no lattice with the zero of the frame."""
    row, column = grid.origin[1] / grid.resolution, grid.origin[0] / grid.resolution
    if abs(row - round(row)) > 1e-3 or abs(column - round(column)) > 1e-3:
        return None
    return round(row), round(column)
