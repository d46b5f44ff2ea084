"""Geometry of occupancy grids. Cells are (row, col); points are (x, y) in metres in the map frame (REP-103)."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Tuple

import numpy as np

from explorer._kernels import lines_are_clear
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
    """An occupancy grid: `cells` is int8 (height, width); free below `FREE_BELOW`, -1 unknown, occupied from
    `OCCUPIED_FROM` on. They must not change any more."""

    info: GridInfo
    cells: np.ndarray

    FREE_BELOW = 25
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

    @cached_property
    def free(self) -> np.ndarray:
        """(height, width) bool array. Cells of middling occupancy are neither free nor unknown nor occupied."""
        return (self.cells >= FREE) & (self.cells < self.FREE_BELOW)

    @cached_property
    def occupied(self) -> np.ndarray:
        return self.cells >= self.OCCUPIED_FROM

    @cached_property
    def unknown(self) -> np.ndarray:
        return self.cells < 0

    @cached_property
    def known_area(self) -> float:
        """m^2."""
        return int(np.count_nonzero(self.cells >= 0)) * self.info.resolution**2


def line_is_clear(blocked: np.ndarray, start: Tuple[int, int], end: Tuple[int, int]) -> bool:
    """True if no cell of the straight line between two cells of a bool array (rows, cols) is blocked; the two ends
    do not count. Cells outside the array count as blocked."""
    return bool(lines_are_clear(blocked, np.array([start]), np.array([end]))[0])
