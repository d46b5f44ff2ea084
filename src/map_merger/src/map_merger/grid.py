"""Occupancy grids as values, and all index arithmetic of the package.

Cells are addressed as (row, column). Row r, column c covers the square from r, c to r + 1, c + 1 (times the
resolution) in the frame of the grid's corner, x along the columns and y along the rows, as in nav_msgs/OccupancyGrid.
"""

import math
from dataclasses import dataclass, field
from typing import Iterable, Iterator, NamedTuple, Tuple

import numpy as np

from mr_grid import Pose

from . import _surfaces

UNKNOWN = -1
FREE = 0
OCCUPIED = 100
OCCUPIED_FROM = 50
"""Cells of at least this value count as obstacles; the others that are not negative as free."""

MAX_CELLS = 64_000_000
"""Larger grids are refused: a forged size must not take the memory of the robot."""
FINEST_M, COARSEST_M = 0.001, 10.0
"""Cells of other sizes are refused."""


class GridError(ValueError):
    """A grid that cannot be used, with the reason."""


@dataclass(frozen=True)
class GridInfo:
    """Geometry of a grid: size in cells, resolution in m per cell, pose of its corner (m, rad) in the map frame."""

    width: int
    height: int
    resolution: float
    origin: Pose = field(default_factory=Pose)

    def __post_init__(self) -> None:
        values = (self.resolution, self.origin.x, self.origin.y, self.origin.yaw)
        if not all(math.isfinite(value) for value in values):
            raise GridError("resolution and origin of a grid must be finite numbers")
        if not FINEST_M <= self.resolution <= COARSEST_M:
            raise GridError(
                f"resolution of a grid must be {FINEST_M:g} m to {COARSEST_M:g} m, not {self.resolution:g} m"
            )
        if self.width < 0 or self.height < 0 or self.width * self.height > MAX_CELLS:
            raise GridError(f"a grid of {self.width} x {self.height} cells is not accepted (at most {MAX_CELLS} cells)")

    @property
    def shape(self) -> Tuple[int, int]:
        """(rows, columns)."""
        return self.height, self.width


class Box(NamedTuple):
    """Half-open rectangle of cells: rows [top, bottom), columns [left, right). May be negative, never inverted."""

    top: int
    left: int
    bottom: int
    right: int

    @property
    def edges(self) -> Tuple[int, int, int, int]:
        """(top, left, bottom, right)."""
        return self.top, self.left, self.bottom, self.right

    @property
    def area(self) -> int:
        """Number of cells."""
        return self.shape[0] * self.shape[1]

    @property
    def empty(self) -> bool:
        """True if it holds no cell."""
        return self.bottom <= self.top or self.right <= self.left

    @property
    def shape(self) -> Tuple[int, int]:
        """(rows, columns)."""
        return max(0, self.bottom - self.top), max(0, self.right - self.left)

    def shifted(self, rows: int, columns: int) -> "Box":
        """The box moved."""
        return Box(self.top + rows, self.left + columns, self.bottom + rows, self.right + columns)

    def grown(self, cells: int) -> "Box":
        """The box with `cells` more on each side."""
        return Box(self.top - cells, self.left - cells, self.bottom + cells, self.right + cells)

    def union(self, other: "Box") -> "Box":
        """Smallest box around both."""
        if self.empty:
            return other
        if other.empty:
            return self
        return Box(
            min(self.top, other.top),
            min(self.left, other.left),
            max(self.bottom, other.bottom),
            max(self.right, other.right),
        )

    def intersection(self, other: "Box") -> "Box":
        """Cells in both."""
        top, left = max(self.top, other.top), max(self.left, other.left)
        return Box(top, left, max(top, min(self.bottom, other.bottom)), max(left, min(self.right, other.right)))

    def contains(self, other: "Box") -> bool:
        """True if every cell of `other` is in this box."""
        return other.empty or self.intersection(other) == other

    def aligned(self, block: int) -> "Box":
        """The box enlarged to whole blocks of `block` cells."""
        return Box(
            self.top // block * block,
            self.left // block * block,
            -(-self.bottom // block) * block,
            -(-self.right // block) * block,
        )

    def tiles(self, size: int) -> Iterator["Box"]:
        """The box cut into tiles of at most `size` x `size` cells, row by row."""
        for top in range(self.top, self.bottom, size):
            for left in range(self.left, self.right, size):
                yield Box(top, left, min(top + size, self.bottom), min(left + size, self.right))

    def slices(self) -> Tuple[slice, slice]:
        """Index of an array that starts at cell (0, 0)."""
        return slice(self.top, self.bottom), slice(self.left, self.right)


EMPTY_BOX = Box(0, 0, 0, 0)


@dataclass(frozen=True, eq=False)
class Grid:
    """A map: geometry and cells (int8, shape (rows, columns), -1 unknown, 0 free .. 100 occupied). Treated as
    immutable."""

    info: GridInfo
    cells: np.ndarray

    def __post_init__(self) -> None:
        if self.cells.shape != self.info.shape:
            raise GridError(f"a grid of {self.info.shape} cells cannot hold {self.cells.shape}")

    @property
    def occupied(self) -> np.ndarray:
        """Boolean array of the obstacles."""
        return self.cells >= OCCUPIED_FROM

    @property
    def free(self) -> np.ndarray:
        """Boolean array of the free cells."""
        return (self.cells >= 0) & (self.cells < OCCUPIED_FROM)


def empty_grid(info: GridInfo) -> Grid:
    """Grid of unknown cells."""
    return Grid(info, np.full(info.shape, UNKNOWN, np.int8))


def grid_of(info: GridInfo, data: np.ndarray) -> Grid:
    """Grid from row-major values of any integer type; GridError if their number does not fit the geometry."""
    values = np.asarray(data)
    if values.size != info.width * info.height:
        raise GridError(f"a map of {info.width} x {info.height} cells came with {values.size} values")
    return Grid(info, values.astype(np.int8, copy=False).reshape(info.shape))


def cell_centres(info: GridInfo, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Centres of the cells in the map frame, shape (n, 2), metres. Fractions of cells are allowed."""
    local = np.stack([np.asarray(columns) + 0.5, np.asarray(rows) + 0.5], axis=-1) * info.resolution
    return info.origin.apply(local)


def continuous_cells(info: GridInfo, points: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Row and column, with fraction, of points (n, 2) in metres; cell r covers [r, r + 1)."""
    local = info.origin.inverse().apply(points) / info.resolution
    return local[:, 1], local[:, 0]


def cells_of(info: GridInfo, points: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Row and column (int64) of the cells that hold points (n, 2) in metres, and whether they are inside the grid."""
    rows, columns = (np.floor(values).astype(np.int64) for values in continuous_cells(info, points))
    inside = (rows >= 0) & (rows < info.height) & (columns >= 0) & (columns < info.width)
    return rows, columns, inside


def values_at(cells: np.ndarray, info: GridInfo, points: np.ndarray, outside: float) -> np.ndarray:
    """Value of `cells` under each of the points (n, 2) in metres, `outside` for points beyond the grid."""
    rows, columns, inside = cells_of(info, points)
    result = np.full(len(points), outside, dtype=cells.dtype)
    result[inside] = cells[rows[inside], columns[inside]]
    return result


def corners(info: GridInfo) -> np.ndarray:
    """The four corners of the grid in the map frame, shape (4, 2), metres."""
    x, y = info.width * info.resolution, info.height * info.resolution
    return info.origin.apply(np.array([[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]]))


def window(info: GridInfo, box: Box) -> GridInfo:
    """Geometry of the cells in `box` (offsets may be negative or beyond the grid) on the same lattice."""
    rows, columns = box.shape
    x, y = info.origin.apply_point(box.left * info.resolution, box.top * info.resolution)
    return GridInfo(columns, rows, info.resolution, Pose(x, y, info.origin.yaw))


def full_box(info: GridInfo) -> Box:
    """All cells of the grid."""
    return Box(0, 0, info.height, info.width)


def offset_between(info: GridInfo, reference: GridInfo) -> Tuple[int, int]:
    """(row, column) of the first cell of `info` on the lattice of `reference`.

    A shift by a fraction of a cell is rounded to the next cell. GridError if resolution or heading differ.
    """
    if abs(info.resolution - reference.resolution) > 1e-4 * reference.resolution:
        raise GridError(f"the resolution changed from {reference.resolution:g} to {info.resolution:g} m")
    if abs(math.remainder(info.origin.yaw - reference.origin.yaw, 2.0 * math.pi)) > 1e-3:
        raise GridError("the heading of the grid's origin changed")
    local = reference.origin.inverse().compose(info.origin)
    return round(local.y / reference.resolution), round(local.x / reference.resolution)


def bounding_box(mask: np.ndarray) -> Box:
    """Smallest box around the true cells of a mask, bool (rows, columns)."""
    return Box(*_surfaces.box_of_true(mask))


def known_cells_box(cells: np.ndarray) -> Box:
    """Smallest box around the known ones of cells, int8 (rows, columns)."""
    return Box(*_surfaces.box_of_others(cells, UNKNOWN))


def changed_box(before: np.ndarray, after: np.ndarray) -> Box:
    """Smallest box around the cells in which two maps, int8 of one shape (rows, columns), differ."""
    return Box(*_surfaces.box_of_changes(before, after))


def known_box(grid: Grid) -> Box:
    """Smallest box around the known cells."""
    return known_cells_box(grid.cells)


def cropped(grid: Grid, box: Box) -> Grid:
    """The cells of `box`; those beyond the grid are unknown."""
    inside = box.intersection(full_box(grid.info))
    if inside == box:
        return Grid(window(grid.info, box), grid.cells[box.slices()])
    result = empty_grid(window(grid.info, box))
    if not inside.empty:
        result.cells[inside.shifted(-box.top, -box.left).slices()] = grid.cells[inside.slices()]
    return result


def box_around(info: GridInfo, points: np.ndarray) -> Box:
    """Smallest box of cells on the lattice of `info` around points (n, 2) in metres; may leave the grid."""
    rows, columns = continuous_cells(info, points)
    return Box(math.floor(rows.min()), math.floor(columns.min()), math.ceil(rows.max()), math.ceil(columns.max()))


def union_of(boxes: Iterable[Box]) -> Box:
    """Smallest box around all."""
    result = EMPTY_BOX
    for box in boxes:
        result = result.union(box)
    return result
