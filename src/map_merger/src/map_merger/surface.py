"""Walls of a grid as oriented surface points: what registration compares.

A wall seen from one room and the same wall seen from the next are two surfaces. Matching only surfaces that face the
same way keeps the thickness of walls out of the estimate, and lets the quantisation of both grids cancel.
"""

from dataclasses import dataclass, field, replace
from typing import List, Tuple

import numpy as np

from mr_grid import UNKNOWN, GridInfo, OccupancyGrid
from mr_grid.imaging import eroded

from ._surfaces import SurfaceIndex, border, walls, without_discs
from .grid import cropped, free_cells, known_box
from .robot_size import LARGEST_PERSON_M

NORMAL_WEIGHT = 0.3
"""Metres that a unit difference of the normals counts in a search for the nearest surface."""

_SMALLEST_WALL = 4
"""Connected obstacles of fewer cells are noise."""
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
    _index: List[SurfaceIndex] = field(default_factory=list, init=False, repr=False)

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

    grid: OccupancyGrid
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
    cells = landmarks.info.cells_of(places)
    cells = cells[landmarks.info.inside(cells)]
    if not len(cells):
        return landmarks
    # Half a cell more, because a place may be anywhere in its cell.
    radius = reach / landmarks.info.resolution + 0.5
    return replace(landmarks, clear=without_discs(landmarks.clear, cells, radius))


def landmarks_of(grid: OccupancyGrid, mover: float = LARGEST_PERSON_M) -> Landmarks:
    """Landmarks of a map; a map without obstacles has an empty surface. Obstacles of up to `mover` m are no walls."""
    around = known_box(grid)
    if around.empty:
        nothing = np.zeros(grid.cells.shape, bool)
        return Landmarks(grid, _surface(grid.info, np.empty((0, 2), int), np.empty(0, bool), nothing), nothing, nothing)
    part = cropped(grid, around.grown(1))
    free = free_cells(part)
    clear = eroded(free, _disc(CLEAR_CELLS))
    return Landmarks(part, _surface(part.info, *_walls(part, mover), free), clear, part.cells != UNKNOWN)


def _surface(info: GridInfo, walls: np.ndarray, large: np.ndarray, free: np.ndarray) -> Surface:
    """Oriented points of the walls' borders to free space; a thin wall that is free on both sides has two faces.

    walls: cells (n, 2; row, column). large: bool (n,), what they belong to. free: bool (rows, columns).
    """
    points, normals, numbers = border(walls, free, info.resolution, info.origin)
    return Surface(points, normals, info.resolution, large[numbers])


def _walls(grid: OccupancyGrid, mover: float) -> Tuple[np.ndarray, np.ndarray]:
    """Cells (n, 2; row, column) of the obstacles without specks, and whether what they belong to is larger than
    `mover` m, bool (n,)."""
    return walls(grid.cells, _SMALLEST_WALL, mover / grid.info.resolution)


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


def _disc(radius: float) -> np.ndarray:
    """Mask (uint8) of the cells at most `radius` cells from the middle one."""
    offset = np.arange(-int(radius), int(radius) + 1)
    return (np.hypot(offset[:, None], offset[None, :]) <= radius).astype(np.uint8)
