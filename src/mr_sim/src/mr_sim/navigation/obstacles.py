"""What the laser has seen lately and the map does not know: doors, people, other robots."""

from typing import Optional

import numpy as np

from mr_sim.navigation.options import Grid, Scan
from mr_sim.pose import Pose, placed

CELL = 0.05  # m, one point is kept per cell of this size
KNOWN_WITHIN = 0.15  # m, hits this near to a wall of the map are that wall
SEEN_BEYOND = 0.25  # m, a beam that goes this far past a remembered point has seen it gone
REMEMBERED_LIMIT = 2000


class ObstacleMemory:
    """Points (x, y, time seen) in the map frame. Bounded: the oldest go first."""

    def __init__(self, duration: float) -> None:
        self._duration = duration
        self._points = np.empty((0, 3))

    @property
    def points(self) -> np.ndarray:
        """(n, 2), map frame."""
        return self._points[:, :2]

    @property
    def size(self) -> int:
        return len(self._points)

    def clear(self) -> None:
        self._points = np.empty((0, 3))

    def update(
        self, scan: Scan, pose: Pose, wall_distance: Optional[np.ndarray], grid: Optional[Grid], now: float
    ) -> None:
        """`wall_distance`: metres from each cell of `grid` to the nearest wall of the map."""
        old = self._points[(now - self._points[:, 2] < self._duration) & (self._points[:, 2] <= now)]
        old = old[~seen_gone(old[:, :2], scan, pose)]
        hits = placed(scan.points, pose)
        if grid is not None and wall_distance is not None:
            hits = hits[~near_walls(hits, wall_distance, grid)]
        fresh = np.column_stack([hits, np.full(len(hits), now)])
        points = np.concatenate([fresh, old])
        self._points = points[np.sort(first_of_squares(points, CELL))][:REMEMBERED_LIMIT]


def first_of_squares(points: np.ndarray, size: float) -> np.ndarray:
    """Index of the first of the points (n, 2 or more) in each square of `size` m, in the order of the squares."""
    if len(points) == 0:
        return np.empty(0, dtype=np.intp)
    squares = np.floor(points[:, :2] / size).astype(np.int64)
    squares -= squares.min(axis=0)
    _, first = np.unique(squares[:, 0] * (squares[:, 1].max() + 1) + squares[:, 1], return_index=True)
    return first


def near_walls(points: np.ndarray, wall_distance: np.ndarray, grid: Grid) -> np.ndarray:
    cells = np.floor((points - grid.origin) / grid.resolution).astype(np.int64)
    rows, columns = grid.cells.shape
    inside = (cells >= 0).all(axis=1) & (cells[:, 0] < columns) & (cells[:, 1] < rows)
    near = np.zeros(len(points), dtype=bool)
    near[inside] = wall_distance[cells[inside, 1], cells[inside, 0]] < KNOWN_WITHIN
    return near


def seen_gone(points: np.ndarray, scan: Scan, pose: Pose) -> np.ndarray:
    """Which remembered points (n, 2) the scan looks through, or would hit if they were still there."""
    eye = placed(np.array([scan.mount[:2]]), pose)[0]
    offset = points - eye
    distance = np.hypot(offset[:, 0], offset[:, 1])
    bearing = np.arctan2(offset[:, 1], offset[:, 0]) - pose[2] - scan.mount[2]
    index = np.round((np.remainder(bearing + np.pi, 2 * np.pi) - np.pi - scan.angle_min) / scan.angle_increment)
    index = index.astype(np.int64)
    inside = (index >= 0) & (index < scan.ranges.size)
    gone = np.zeros(len(points), dtype=bool)
    gone[inside] = scan.ranges[index[inside]] > distance[inside] + SEEN_BEYOND
    return gone
