"""What came into the robot's own map where it had shown free ground: things that move, not walls."""

from typing import Dict, Optional, Tuple

import cv2
import numpy as np

from mr_grid import OccupancyGrid
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

    def update(self, own: OccupancyGrid, now: float) -> None:
        """`own`: the robot's latest own map."""
        before, offset = self._before, _cells_of(own)
        if before is None or before.resolution != own.resolution or offset is None:
            self._before, self._since = (None if offset is None else own), {}
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
        self._before, self._since = OccupancyGrid(own.info, cells), kept

    @property
    def settled(self) -> Optional[OccupancyGrid]:
        """The robot's latest own map with free cells in place of what has come lately."""
        return self._before

    def taken_from(self, grid: OccupancyGrid, now: float) -> OccupancyGrid:
        """A map with free cells in place of what has come lately."""
        offset = _cells_of(grid)
        present = [cell for cell, since in self._since.items() if now - since < self._settles]
        if offset is None or self._before is None or self._before.resolution != grid.resolution or not present:
            return grid
        places = np.array(present) - offset
        places = places[((places >= 0) & (places < grid.cells.shape)).all(axis=1)]
        cells = grid.cells.copy()
        cells[places[:, 0], places[:, 1]] = np.minimum(cells[places[:, 0], places[:, 1]], 0)
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
        # Beside a wall it is that wall, seen better.
        came &= cv2.dilate((old > 50).astype(np.uint8), np.ones((3, 3), np.uint8)) == 0
        # What is larger came because SLAM draws its map elsewhere.
        return np.add(np.argwhere(_small(came, round(REACH / after.resolution))), (a, b))


def _small(cells: np.ndarray, most: int) -> np.ndarray:
    """Those of the cells, bool (rows, columns), that hang together in no more than `most` rows and columns."""
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(cells.astype(np.uint8), connectivity=8)
    extent = np.maximum(statistics[:, cv2.CC_STAT_WIDTH], statistics[:, cv2.CC_STAT_HEIGHT])
    return cells & (extent <= most)[labels]


def _cells_of(grid: OccupancyGrid) -> Optional[Cell]:
    """Where the corner of the grid lies on the lattice; None if on no lattice with the zero of the frame."""
    row, column = grid.origin[1] / grid.resolution, grid.origin[0] / grid.resolution
    if abs(row - round(row)) > 1e-3 or abs(column - round(column)) > 1e-3:
        return None
    return round(row), round(column)
