"""Occupancy grids as values, and where their cells lie.

Cells are addressed as (row, column). Row r, column c covers the square from r, c to r + 1, c + 1 (times the
resolution) in the frame of the grid's origin, x along the columns and y along the rows, as in nav_msgs/OccupancyGrid.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Tuple

import numpy as np

from mr_grid import _imaging
from mr_grid.pose import IDENTITY, Pose

UNKNOWN = -1
FREE = 0
OCCUPIED = 100

FINEST, COARSEST = 1e-3, 1e2  # m: cells of other sizes are refused
MAX_CELLS = 64_000_000
"""Larger grids are refused: a forged size must not take the memory of the robot."""


class GridError(ValueError):
    """A grid that cannot be used, with the reason."""


@dataclass(frozen=True)
class GridInfo:
    """Placement of a grid: size in cells, edge length of a cell in m, and pose of the outer corner of cell (0, 0) in
    the map frame. GridError for what cannot be one."""

    width: int
    height: int
    resolution: float
    origin: Pose = IDENTITY

    def __post_init__(self) -> None:
        if not all(math.isfinite(value) for value in (self.resolution, *self.origin)):
            raise GridError(f"resolution ({self.resolution}) and origin {tuple(self.origin)} of a grid must be finite")
        if not FINEST <= self.resolution <= COARSEST:
            raise GridError(f"resolution of a grid must be {FINEST:g} m to {COARSEST:g} m, not {self.resolution:g} m")
        if self.width < 0 or self.height < 0 or self.width * self.height > MAX_CELLS:
            raise GridError(f"a grid of {self.width} x {self.height} cells is not accepted (at most {MAX_CELLS} cells)")

    @property
    def shape(self) -> Tuple[int, int]:
        """(rows, columns)."""
        return self.height, self.width

    def cell_of(self, x: float, y: float) -> Tuple[int, int]:
        """(row, column) of the cell that contains the point; it may lie outside the grid."""
        origin, resolution = self.origin, self.resolution
        x, y = x - origin.x, y - origin.y
        if origin.yaw:
            cosine, sine = math.cos(origin.yaw), math.sin(origin.yaw)
            x, y = cosine * x + sine * y, cosine * y - sine * x
        return math.floor(y / resolution), math.floor(x / resolution)

    def cells_of(self, points: np.ndarray) -> np.ndarray:
        """(row, column), int (n, 2), of the cells that contain points (n, 2) in metres; they may lie outside."""
        return np.stack(self.rows_and_columns(points), axis=1)

    def rows_and_columns(self, points: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Rows and columns, int (n,) each, of the cells that contain points (n, 2) in metres."""
        # Column by column: many times faster than along rows of two.
        x, y = (np.floor(axis / self.resolution).astype(np.int64) for axis in self._local(points).T)
        return y, x

    def continuous_cells(self, points: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Rows and columns with fraction, float (n,) each, of points (n, 2) in metres; row r covers [r, r + 1)."""
        local = self._local(points) / self.resolution
        return local[:, 1], local[:, 0]

    def centre_of(self, row: float, column: float) -> Tuple[float, float]:
        """(x, y) in metres of the centre of a cell."""
        x, y = (column + 0.5) * self.resolution, (row + 0.5) * self.resolution
        return self.origin.apply_point(x, y) if self.origin.yaw else (self.origin.x + x, self.origin.y + y)

    def centres_of(self, cells: np.ndarray) -> np.ndarray:
        """Centres (n, 2) in metres of cells (n, 2), which may have fractions."""
        cells = np.asarray(cells).reshape(-1, 2)
        return self.centres(cells[:, 0], cells[:, 1])

    def centres(self, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """`centres_of` for rows and columns (n,) each."""
        local = np.stack([np.asarray(columns) + 0.5, np.asarray(rows) + 0.5], axis=-1) * self.resolution
        return self.origin.apply(local)

    def contains(self, row: int, column: int) -> bool:
        return 0 <= row < self.height and 0 <= column < self.width

    def inside(self, cells: np.ndarray) -> np.ndarray:
        """Which of the cells (n, 2) lie in the grid, bool (n,)."""
        return (cells[:, 0] >= 0) & (cells[:, 0] < self.height) & (cells[:, 1] >= 0) & (cells[:, 1] < self.width)

    def corners(self) -> np.ndarray:
        """The four corners of the grid, (4, 2) in metres."""
        x, y = self.width * self.resolution, self.height * self.resolution
        return self.origin.apply(np.array([[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]]))

    def _local(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 2) as seen from the origin, m."""
        return self.origin.apply_inverse(np.asarray(points, dtype=float).reshape(-1, 2))


@dataclass(frozen=True, eq=False)
class OccupancyGrid:
    """A map: placement and cells (int8, (rows, columns), -1 unknown, 0 free to 100 occupied), which must not change any
    more. From which value on a cell counts as obstacle is up to who reads it."""

    info: GridInfo
    cells: np.ndarray

    def __post_init__(self) -> None:
        if self.cells.shape != self.info.shape:
            raise GridError(
                f"map data holds {self.cells.size} cells {self.cells.shape}, "
                f"its description says {self.info.width} x {self.info.height}"
            )

    @classmethod
    def of(cls, cells: np.ndarray, resolution: float, origin: Pose = IDENTITY) -> "OccupancyGrid":
        """The map with cells (rows, columns) of `resolution` m whose corner is at `origin`."""
        rows, columns = cells.shape
        return cls(GridInfo(columns, rows, resolution, origin), cells)

    @property
    def resolution(self) -> float:
        """m per cell."""
        return self.info.resolution

    @property
    def origin(self) -> Pose:
        """Of the outer corner of cell (0, 0)."""
        return self.info.origin

    @cached_property
    def unknown(self) -> np.ndarray:
        """Cells never seen, bool (rows, columns)."""
        return self.cells < FREE

    def values_at(self, points: np.ndarray, outside: int = UNKNOWN) -> np.ndarray:
        """Values (n,) at points (n, 2) in metres, `outside` for those beyond the grid."""
        return values_at(self.cells, self.info, points, outside)

    def equals(self, other: "OccupancyGrid") -> bool:
        """Whether both say the same of the same place."""
        return self.info == other.info and (self.cells is other.cells or np.array_equal(self.cells, other.cells))


def empty_grid(info: GridInfo) -> OccupancyGrid:
    """Grid of unknown cells."""
    return OccupancyGrid(info, np.full(info.shape, UNKNOWN, np.int8))


def grid_of(info: GridInfo, data: np.ndarray) -> OccupancyGrid:
    """Grid from row-major values of any integer type; GridError if their number does not fit the placement."""
    values = np.asarray(data)
    if values.size != info.width * info.height:
        raise GridError(f"map data holds {values.size} cells, its description says {info.width} x {info.height}")
    return OccupancyGrid(info, values.astype(np.int8, copy=False).reshape(info.shape))


def values_at(cells: np.ndarray, info: GridInfo, points: np.ndarray, outside: float) -> np.ndarray:
    """Value of `cells` (rows, columns), of any type, at points (n, 2) in metres, `outside` beyond the grid."""
    if cells.dtype == np.int8 and not info.origin.yaw:
        flat = np.asarray(points, dtype=float).reshape(-1, 2)
        return _imaging.values_at(cells, info.resolution, info.origin[:2], flat, int(outside))
    rows, columns = info.rows_and_columns(points)
    inside = (rows >= 0) & (rows < info.height) & (columns >= 0) & (columns < info.width)
    if not cells.size:
        return np.full(len(rows), outside, dtype=cells.dtype)
    # Taking all and overwriting those outside is faster than choosing first.
    values = cells.ravel().take(np.where(inside, rows * info.width + columns, 0))
    values[~inside] = outside
    return values
