"""The true walls on the lattice of a robot's map, of which it gets to know what it sees."""

from __future__ import annotations

import cv2
import numpy as np

from mr_grid import OccupancyGrid, Pose

RESOLUTION = 0.1  # m; twice that of SLAM, which the strategy does not notice and the time does


class TrueMap:
    """Masks of what has been seen are uint8 (rows, columns); see `nothing`."""

    def __init__(self, walls: OccupancyGrid, start: Pose) -> None:
        """`start`: origin of the map frame, world frame."""
        self._start = start
        self._cells, self._origin = _in_map_frame(walls, start)

    def nothing(self) -> np.ndarray:
        """The mask of a robot that has not seen anything."""
        return np.zeros(self._cells.shape, dtype=np.uint8)

    def add(self, area: np.ndarray, seen: np.ndarray) -> None:
        """Adds a polygon (n, 2), world frame in m, to a mask."""
        cells = (self._start.apply_inverse(area) - self._origin) / RESOLUTION
        cv2.fillPoly(seen, [np.floor(cells).astype(np.int32)], 1)

    def wall_length(self, seen: np.ndarray) -> float:
        """m of wall that a mask shows."""
        return int(np.count_nonzero(self._cells[seen > 0])) * RESOLUTION

    def known(self, seen: np.ndarray) -> OccupancyGrid:
        """The map of someone who has seen that much: its bounding box."""
        left, low, width, height = cv2.boundingRect(seen)
        window = np.s_[low : low + height, left : left + width]
        cells = np.where(seen[window] > 0, self._cells[window], np.int8(-1))
        corner = Pose(self._origin[0] + left * RESOLUTION, self._origin[1] + low * RESOLUTION)
        return OccupancyGrid.of(cells, RESOLUTION, corner)


def _in_map_frame(walls: OccupancyGrid, start: Pose) -> tuple[np.ndarray, np.ndarray]:
    """int8 cells, 0 free, 100 occupied where any part of a cell may be, and the lower left corner, m."""
    rows, columns = walls.cells.shape
    size = np.array([columns, rows]) * walls.resolution
    corners = np.array([[0.0, 0.0], [size[0], 0.0], [size[0], size[1]], [0.0, size[1]]]) + walls.origin[:2]
    local = start.apply_inverse(corners)
    low = np.floor(local.min(axis=0) / RESOLUTION) - 1
    high = np.ceil(local.max(axis=0) / RESOLUTION) + 1
    width, height = (high - low).astype(int)
    origin = low * RESOLUTION
    grid = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).reshape(-1, 2)
    centres = start.apply((grid + 0.5) * RESOLUTION + origin)
    index = np.floor((centres - walls.origin[:2]) / walls.resolution).astype(np.int64)
    inside = ((index >= 0) & (index < (columns, rows))).all(axis=1)
    cells = np.zeros(len(centres), dtype=np.int8)
    cells[inside] = np.where(walls.cells[index[inside, 1], index[inside, 0]] > 0, 100, 0)
    return cells.reshape(height, width), origin
