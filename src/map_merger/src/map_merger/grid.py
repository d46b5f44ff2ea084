"""Rectangles of cells, what fills them, and what fusion and registration take for an obstacle.

Cells are addressed as (row, column), as in `mr_grid.grid`.
"""

import math
from typing import Iterable, Iterator, NamedTuple, Tuple

import numpy as np

from mr_grid import UNKNOWN, GridError, GridInfo, OccupancyGrid, Pose, empty_grid

from . import _surfaces

OCCUPIED_FROM = 50
"""Cells of at least this value count as obstacles; the others that are not negative as free."""


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


def occupied_cells(grid: OccupancyGrid) -> np.ndarray:
    """The obstacles, bool (rows, columns)."""
    return grid.cells >= OCCUPIED_FROM


def free_cells(grid: OccupancyGrid) -> np.ndarray:
    """Bool (rows, columns)."""
    return (grid.cells >= 0) & (grid.cells < OCCUPIED_FROM)


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


def known_box(grid: OccupancyGrid) -> Box:
    """Smallest box around the known cells."""
    return known_cells_box(grid.cells)


def cropped(grid: OccupancyGrid, box: Box) -> OccupancyGrid:
    """The cells of `box`; those beyond the grid are unknown."""
    inside = box.intersection(full_box(grid.info))
    if inside == box:
        return OccupancyGrid(window(grid.info, box), grid.cells[box.slices()])
    result = empty_grid(window(grid.info, box))
    if not inside.empty:
        result.cells[inside.shifted(-box.top, -box.left).slices()] = grid.cells[inside.slices()]
    return result


def box_around(info: GridInfo, points: np.ndarray) -> Box:
    """Smallest box of cells on the lattice of `info` around points (n, 2) in metres; may leave the grid."""
    rows, columns = info.continuous_cells(points)
    return Box(math.floor(rows.min()), math.floor(columns.min()), math.ceil(rows.max()), math.ceil(columns.max()))


def union_of(boxes: Iterable[Box]) -> Box:
    """Smallest box around all."""
    result = EMPTY_BOX
    for box in boxes:
        result = result.union(box)
    return result
