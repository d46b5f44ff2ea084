"""Walls of a grid as oriented surface points: what registration compares.

A wall seen from one room and the same wall seen from the next are two surfaces. Matching only surfaces that face the
same way keeps the thickness of walls out of the estimate, and lets the quantisation of both grids cancel.
"""

from dataclasses import dataclass, field, replace
from typing import List, Sequence, Tuple

import cv2
import numpy as np

from ._surface_index import SurfaceIndex
from .grid import UNKNOWN, Grid, GridInfo, cell_centres, cells_of, cropped, known_box

NORMAL_WEIGHT = 0.3
"""Metres that a unit difference of the normals counts in a search for the nearest surface."""

_WINDOW = 7
"""Side in cells of the neighbourhood from which the direction of a wall is taken."""
_SMALLEST_WALL = 4
"""Connected obstacles of fewer cells are noise."""
LARGEST_MOVER_M = 0.9
"""Connected obstacles of at most this extent may be robots or people."""
CLEAR_CELLS = 3.0
"""Free cells farther than this from anything else are well observed: a wall of the other map there is a conflict."""


@dataclass(frozen=True, eq=False)
class Surface:
    """Oriented wall points of a map in its frame.

    points: float64 (n, 2), metres, on the border between obstacle and free space. normals: float64 (n, 2), unit,
    towards free space. spacing: metres of wall for which one point stands. solid: bool (n,), part of something larger
    than a robot; only that can contradict free space, since robots and people move.
    """

    points: np.ndarray
    normals: np.ndarray
    spacing: float
    solid: np.ndarray
    _index: List[SurfaceIndex] = field(default_factory=list, repr=False)

    @property
    def length(self) -> float:
        """Metres of wall, each face counted."""
        return len(self.points) * self.spacing

    def index(self) -> SurfaceIndex:
        """For searches over position and weighted normal, built once."""
        if not self._index:
            self._index.append(SurfaceIndex(self.points, self.normals, NORMAL_WEIGHT))
        return self._index[0]


@dataclass(frozen=True, eq=False)
class Landmarks:
    """All that registration needs of a map, computed once per map.

    grid: the known part. surface: its walls. clear: bool per cell, well observed free space. known: bool per cell.
    """

    grid: Grid
    surface: Surface
    clear: np.ndarray
    known: np.ndarray

    @property
    def info(self) -> GridInfo:
        """Geometry of the known part."""
        return self.grid.info


def without_places(landmarks: Landmarks, places: np.ndarray, reach: float) -> Landmarks:
    """The same landmarks, but nothing within `reach` (m) of `places` (n, 2; m, in the map's frame) counts as clear.

    For places where the robot of this map has been: another robot may have seen it there, and has it as a wall.
    """
    if not len(places) or not landmarks.clear.size:
        return landmarks
    rows, columns, inside = cells_of(landmarks.info, places)
    elsewhere = np.ones(landmarks.clear.shape, np.uint8)
    elsewhere[rows[inside], columns[inside]] = 0
    if elsewhere.all():
        return landmarks
    # Half a cell more, because a place may be anywhere in its cell.
    far = cv2.erode(elsewhere, _disc(reach / landmarks.info.resolution + 0.5)).astype(bool)
    return replace(landmarks, clear=landmarks.clear & far)


def landmarks_of(grid: Grid) -> Landmarks:
    """Landmarks of a map; a map without obstacles has an empty surface."""
    part = cropped(grid, known_box(grid).grown(1)) if (grid.cells != UNKNOWN).any() else grid
    free = part.free
    if free.size == 0:
        return Landmarks(part, _empty_surface(part.info.resolution), free, free)
    clear = cv2.erode(free.astype(np.uint8), _disc(CLEAR_CELLS)).astype(bool)
    return Landmarks(part, surface_of(part.info, part.occupied, free), clear, part.cells != UNKNOWN)


def surface_of(info: GridInfo, occupied: np.ndarray, free: np.ndarray) -> Surface:
    """Oriented points of the obstacles' borders to free space; a thin wall that is free on both sides has two faces.

    occupied, free: bool (rows, columns). Specks are left out.
    """
    rows, columns, extent = _obstacles(occupied)
    if rows.size == 0:
        return _empty_surface(info.resolution)
    normal_rows, normal_columns, linearity = _directions(occupied.shape, rows, columns)
    points, normals, solid = [], [], []
    large = extent * info.resolution > LARGEST_MOVER_M
    for side in (1.0, -1.0):
        open_side = _free_towards(free, rows, columns, side * normal_rows, side * normal_columns)
        keep = open_side & (linearity > 0.6)
        step_rows, step_columns = side * normal_rows[keep], side * normal_columns[keep]
        points.append(cell_centres(info, rows[keep] + 0.5 * step_rows, columns[keep] + 0.5 * step_columns))
        normals.append(np.stack([step_columns, step_rows], axis=1) @ info.origin.rotation().T)
        solid.append(large[keep])
    return Surface(np.concatenate(points), np.concatenate(normals), info.resolution, np.concatenate(solid))


def subsample(surface: Surface, most: int) -> Surface:
    """At most `most` points, evenly taken over the surface (deterministic)."""
    count = len(surface.points)
    if count <= most:
        return surface
    order = np.lexsort((surface.points[:, 0].round(1), surface.points[:, 1].round(1)))
    chosen = order[np.linspace(0, count - 1, most).astype(int)]
    return Surface(
        surface.points[chosen], surface.normals[chosen], surface.spacing * count / most, surface.solid[chosen]
    )


def _empty_surface(spacing: float) -> Surface:
    return Surface(np.empty((0, 2)), np.empty((0, 2)), spacing, np.empty(0, bool))


def _disc(radius: float) -> np.ndarray:
    """Mask (uint8) of the cells at most `radius` cells from the middle one."""
    offset = np.arange(-int(radius), int(radius) + 1)
    return (np.hypot(offset[:, None], offset[None, :]) <= radius).astype(np.uint8)


def _obstacles(occupied: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows and columns of the obstacles without specks, and for each cell the extent in cells of its connected
    obstacle."""
    rows, columns = np.divmod(np.flatnonzero(occupied), occupied.shape[1])
    if rows.size == 0:
        return rows, columns, rows
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(occupied.astype(np.uint8), connectivity=8)
    extent = np.maximum(statistics[:, cv2.CC_STAT_WIDTH], statistics[:, cv2.CC_STAT_HEIGHT])
    label = labels[rows, columns]
    wall = statistics[label, cv2.CC_STAT_AREA] >= _SMALLEST_WALL
    return rows[wall], columns[wall], extent[label[wall]]


def _directions(shape: Sequence[int], rows: np.ndarray, columns: np.ndarray) -> tuple:
    """Unit normal (row part, column part) of the wall through each obstacle cell of a map of this shape, and how
    line-like it is there (0 .. 1).

    Second moments of the obstacles in the window around the cell. Each row of a window is read as one number, whose
    bits are its cells, and its moments are looked up.
    """
    half = _WINDOW // 2
    mask = np.zeros((shape[0] + 2 * half, shape[1] + 2 * half), np.float32)
    mask[rows + half, columns + half] = 1.0
    patterns = cv2.filter2D(mask, -1, 2.0 ** np.arange(_WINDOW)[None, :]).astype(np.intp)
    offset = np.arange(-half, half + 1)
    stride = shape[1] + 2 * half
    window_rows = patterns.ravel().take(((rows + half) * stride + columns + half)[:, None] + offset * stride)
    counts, sums, squares = (moment.take(window_rows) for moment in _MOMENTS)
    count = counts.sum(axis=1)
    mean_row, mean_column = counts @ offset / count, sums.sum(axis=1) / count
    spread_row = counts @ offset**2 / count - mean_row**2
    spread_column = squares.sum(axis=1) / count - mean_column**2
    mixed = sums @ offset / count - mean_row * mean_column
    tangent = 0.5 * np.arctan2(2.0 * mixed, spread_column - spread_row)
    anisotropy = np.hypot(spread_column - spread_row, 2.0 * mixed) / np.maximum(spread_column + spread_row, 1e-6)
    return np.cos(tangent), -np.sin(tangent), anisotropy


def _moments_of_patterns() -> np.ndarray:
    """Count, sum and sum of squares of the offsets of the set cells, for each pattern of a row: (3, 2**_WINDOW)."""
    patterns = np.arange(2**_WINDOW)
    cells = (patterns[:, None] >> np.arange(_WINDOW)) & 1
    offset = np.arange(_WINDOW) - _WINDOW // 2
    return np.stack([cells.sum(axis=1), cells @ offset, cells @ offset**2]).astype(float)


_MOMENTS = _moments_of_patterns()


def _free_towards(
    free: np.ndarray, rows: np.ndarray, columns: np.ndarray, step_rows: np.ndarray, step_columns: np.ndarray
) -> np.ndarray:
    row = np.clip(np.rint(rows + 1.2 * step_rows).astype(int), 0, free.shape[0] - 1)
    column = np.clip(np.rint(columns + 1.2 * step_columns).astype(int), 0, free.shape[1] - 1)
    return free[row, column]
