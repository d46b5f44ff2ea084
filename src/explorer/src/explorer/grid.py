"""Geometry of occupancy grids. Cells are (row, col); points are (x, y) in metres in the map frame (REP-103)."""

import math
from dataclasses import dataclass
from typing import Tuple

import numpy as np

from explorer.errors import MapError

FREE = 0
OCCUPIED = 100
UNKNOWN = -1

# Farther than this from the origin of its frame, in metres, nothing is: larger coordinates are mistakes or forged, and
# arithmetic on cells and places goes wrong with them.
FARTHEST = 1e5

FINEST, COARSEST = 1e-3, 1e2  # edge lengths in metres of the cells of a map


def is_place(*coordinates: float) -> bool:
    """True if coordinates in metres are numbers of a usable size."""
    return all(abs(value) <= FARTHEST for value in coordinates)


@dataclass(frozen=True)
class GridInfo:
    """Placement of a grid: edge length of a cell in metres, size in cells, and the map coordinates of the outer
    corner of cell (0, 0)."""

    resolution: float
    width: int
    height: int
    origin_x: float
    origin_y: float

    def cell_of(self, x: float, y: float) -> Tuple[int, int]:
        """(row, col) of the cell that contains the point; it may lie outside the grid."""
        return (
            math.floor((y - self.origin_y) / self.resolution),
            math.floor((x - self.origin_x) / self.resolution),
        )

    def cells_of(self, points: np.ndarray) -> np.ndarray:
        """(n, 2) int array of (row, col) for an (n, 2) float array of (x, y) in metres."""
        offset = (np.asarray(points, dtype=float).reshape(-1, 2) - (self.origin_x, self.origin_y)) / self.resolution
        return np.floor(offset).astype(np.int64)[:, ::-1]

    def centre_of(self, row: float, col: float) -> Tuple[float, float]:
        """(x, y) in metres of the centre of a cell."""
        return (
            self.origin_x + (col + 0.5) * self.resolution,
            self.origin_y + (row + 0.5) * self.resolution,
        )

    def centres_of(self, cells: np.ndarray) -> np.ndarray:
        """(n, 2) float array of (x, y) in metres for an (n, 2) array of (row, col)."""
        cells = np.asarray(cells, dtype=float).reshape(-1, 2)
        return (cells[:, ::-1] + 0.5) * self.resolution + (self.origin_x, self.origin_y)

    def contains(self, row: int, col: int) -> bool:
        return 0 <= row < self.height and 0 <= col < self.width

    def inside(self, cells: np.ndarray) -> np.ndarray:
        """(n,) bool array: which of the (n, 2) cells lie in the grid."""
        return (cells[:, 0] >= 0) & (cells[:, 0] < self.height) & (cells[:, 1] >= 0) & (cells[:, 1] < self.width)


@dataclass(frozen=True)
class OccupancyMap:
    """An occupancy grid: `cells` is int8 (height, width); 0 is free, -1 unknown, occupied from `OCCUPIED_FROM` on."""

    info: GridInfo
    cells: np.ndarray

    OCCUPIED_FROM = 50

    def __post_init__(self) -> None:
        info = self.info
        if not FINEST <= info.resolution <= COARSEST:
            raise MapError(f"map resolution is {info.resolution} m; it must be from {FINEST:g} to {COARSEST:g}")
        if not is_place(info.origin_x, info.origin_y):
            raise MapError(f"map origin is ({info.origin_x}, {info.origin_y}); it must be within {FARTHEST:g} m")
        if info.width < 1 or info.height < 1:
            raise MapError(f"map has {info.width} x {info.height} cells; it needs at least one")
        if self.cells.shape != (info.height, info.width):
            raise MapError(f"map data holds {self.cells.size} cells, its description says {info.width} x {info.height}")

    @property
    def free(self) -> np.ndarray:
        """(height, width) bool array. Cells of middling occupancy are neither free nor unknown nor occupied."""
        return (self.cells >= FREE) & (self.cells < 25)

    @property
    def occupied(self) -> np.ndarray:
        return self.cells >= self.OCCUPIED_FROM

    @property
    def unknown(self) -> np.ndarray:
        return self.cells < 0


def line_is_clear(blocked: np.ndarray, start: Tuple[int, int], end: Tuple[int, int]) -> bool:
    """True if no cell of the straight line between two cells of a bool array (rows, cols) is blocked; the two ends
    do not count. Cells outside the array count as blocked."""
    steps = max(abs(end[0] - start[0]), abs(end[1] - start[1]))
    if steps < 2:
        return True
    t = np.arange(1, steps) / steps
    rows = np.rint(start[0] + (end[0] - start[0]) * t).astype(np.int64)
    cols = np.rint(start[1] + (end[1] - start[1]) * t).astype(np.int64)
    if rows.min() < 0 or cols.min() < 0 or rows.max() >= blocked.shape[0] or cols.max() >= blocked.shape[1]:
        return False
    return not blocked[rows, cols].any()


def lines_are_clear(blocked: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """(n,) bool: `line_is_clear` for n pairs of cells, each an (n, 2) int array of (row, col)."""
    starts = np.asarray(starts, dtype=float).reshape(-1, 2)
    ends = np.asarray(ends, dtype=float).reshape(-1, 2)
    if len(starts) == 0:
        return np.zeros(0, dtype=bool)
    steps = int(np.abs(ends - starts).max())
    if steps < 2:
        return np.ones(len(starts), dtype=bool)
    t = (np.arange(1, steps) / steps)[None, :, None]
    line = np.rint(starts[:, None, :] + (ends - starts)[:, None, :] * t).astype(np.int64)
    rows, cols = line[..., 0], line[..., 1]
    inside = (rows >= 0) & (cols >= 0) & (rows < blocked.shape[0]) & (cols < blocked.shape[1])
    hit = ~inside | blocked[np.clip(rows, 0, blocked.shape[0] - 1), np.clip(cols, 0, blocked.shape[1] - 1)]
    # A short line among long ones is sampled several times in its end cells, which must not count.
    end_cell = np.rint(ends).astype(np.int64)[:, None, :]
    start_cell = np.rint(starts).astype(np.int64)[:, None, :]
    at_end = (line == end_cell).all(axis=2) | (line == start_cell).all(axis=2)
    return ~(hit & ~at_end).any(axis=1)
