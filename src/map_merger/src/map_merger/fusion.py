"""Fusion of the local map and the maps of others on the lattice of the local map.

Rules, in this order:

1. A known local cell stays as it is.
2. Elsewhere the maps of others count in their given order (best supported first); the first that knows the cell
   decides.
3. A foreign wall that falls on a free local cell is dropped. Where that cell borders on unknown local ones, those
   become obstacles: a wall that lies one cell off must not open because the local map saw the floor in front of it.
4. Small isolated obstacles where a robot is known to have been are robots, not walls, and are dropped from the foreign
   maps.
"""

from typing import List, NamedTuple, Optional, Sequence

import cv2
import numpy as np
from scipy.spatial import cKDTree

from .grid import (
    FREE,
    OCCUPIED,
    OCCUPIED_FROM,
    UNKNOWN,
    Box,
    Grid,
    GridInfo,
    box_around,
    cell_centres,
    cells_of,
    corners,
    cropped,
    full_box,
    known_box,
    union_of,
    window,
)
from .obstacles import obstacles_of
from .transform import Transform

GROWTH_BLOCK = 20
"""The global map grows beyond the local one by whole blocks of cells, so that its size does not change with every
refinement."""
MOST_GLOBAL_CELLS = 16_000_000
"""Others' maps may not make the global map larger than this (200 m x 200 m of 0.05 m)."""
ROBOT_REACH = 0.45
"""Metres from a robot's centre within which an isolated obstacle is taken for the robot."""
_SMUDGE_CELLS_M = 0.8
"""Largest extent in metres of such an obstacle."""


_LARGEST_WARP = 16_000
"""Side in cells of what OpenCV warps at once: its coordinates have 16 bits."""


class Layer(NamedTuple):
    """A foreign map on the local lattice: cells (int8) of `box`, counted from the local map's corner."""

    box: Box
    cells: np.ndarray


def resampled(foreign: Grid, transform: Transform, local: Grid) -> Optional[Layer]:
    """The foreign map (transform: foreign frame -> local frame) on the local lattice; None if it knows nothing or
    would have more than MOST_GLOBAL_CELLS there.

    Each local cell takes the value of the foreign cell under its centre, which keeps walls as thick as they are. Walls
    that hang together only at the corners of cells may break that way, so those links are drawn as well.
    """
    known = known_box(foreign)
    if known.empty:
        return None
    part = cropped(foreign, known)
    box = box_around(local.info, transform.apply(corners(part.info)))
    if box.area > MOST_GLOBAL_CELLS:
        return None
    target = window(local.info, box)
    cells = _under_centres(part, transform, target)
    links = transform.apply(_corner_links(part))
    rows, columns, inside = cells_of(target, links)
    cells[rows[inside], columns[inside]] = OCCUPIED
    return Layer(box, cells)


def _under_centres(part: Grid, transform: Transform, target: GridInfo) -> np.ndarray:
    """Value of the foreign cell under each centre of the target's cells, by inverse mapping."""
    info = part.info
    corner = cell_centres(target, np.array([0, 0, 1]), np.array([0, 1, 0]))
    image = info.origin.inverse().apply(transform.inverse().apply(corner)) / info.resolution
    start, per_column, per_row = image[0], image[1] - image[0], image[2] - image[0]
    cells = np.empty(target.shape, np.int8)
    for tile in full_box(target).tiles(_LARGEST_WARP):
        # Column and row of the foreign map (0.5 in the middle of its first cell) under the tile's first cell.
        first = start + tile.left * per_column + tile.top * per_row
        across, along = tile.shape[1] * per_column, tile.shape[0] * per_row
        tile_corners = first + np.array([0.0 * across, across, along, across + along])
        (left, top), (right, bottom) = np.floor(tile_corners.min(axis=0)), np.ceil(tile_corners.max(axis=0))
        source = Box(int(top), int(left), int(bottom), int(right)).intersection(full_box(info))
        if source.empty:
            cells[tile.slices()] = UNKNOWN
            continue
        offset = first - (source.left, source.top) - 0.5
        cells[tile.slices()] = cv2.warpAffine(
            part.cells[source.slices()].view(np.uint8),
            np.column_stack([per_column, per_row, offset]),
            tile.shape[::-1],
            flags=cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP,
            borderMode=cv2.BORDER_CONSTANT,
            borderValue=int(np.int8(UNKNOWN).view(np.uint8)),
        ).view(np.int8)
    return cells


def _corner_links(part: Grid) -> np.ndarray:
    """Points (n, 2) along the links between obstacles that touch only at a corner: both centres and the corner."""
    occupied = np.pad(part.occupied, ((1, 1), (0, 1)))
    cell, right = occupied[1:-1, :-1], occupied[1:-1, 1:]
    links: List[np.ndarray] = []
    for step in (1, -1):
        beside = occupied[1 + step : occupied.shape[0] - 1 + step]
        linked = cell & beside[:, 1:] & ~right & ~beside[:, :-1]
        corner = np.column_stack(np.divmod(np.flatnonzero(linked), part.info.width))
        links += [corner + np.array([step * share, share]) for share in (0.0, 0.5, 1.0)]
    return cell_centres(part.info, *np.concatenate(links).T)


def without_robots(grid: Grid, places: np.ndarray) -> Grid:
    """The map without small isolated obstacles around the places (n, 2; metres, in the map's frame) where robots
    were."""
    if not len(places):
        return grid
    obstacles = obstacles_of(grid.occupied)
    small = np.flatnonzero(obstacles.extents() * grid.info.resolution <= _SMUDGE_CELLS_M)
    small = small[small > 0]
    if small.size == 0:
        return grid
    middles = cell_centres(grid.info, *obstacles.centres[small].T)
    distance, _ = cKDTree(places).query(middles, distance_upper_bound=ROBOT_REACH)
    cells = grid.cells.copy()
    for robot in small[np.isfinite(distance)]:
        box = Box(*obstacles.boxes[robot].tolist()).slices()
        cells[box][obstacles.labels[box] == robot] = FREE
    return Grid(grid.info, cells)


def fitting(local: Grid, layers: Sequence[Layer]) -> List[Layer]:
    """The layers, in their order, without those that would make the global map too large."""
    kept: List[Layer] = []
    for layer in layers:
        if _extent(local, [*kept, layer]).area <= max(MOST_GLOBAL_CELLS, full_box(local.info).area):
            kept.append(layer)
    return kept


def _extent(local: Grid, layers: Sequence[Layer]) -> Box:
    """The cells of the global map, counted from the local corner."""
    here = full_box(local.info)
    foreign = union_of(layer.box for layer in layers)
    # Only sides on which others know more grow, by whole blocks counted from the local corner.
    return here if here.contains(foreign) else here.union(foreign.aligned(GROWTH_BLOCK))


def fused(local: Grid, layers: Sequence[Layer]) -> Grid:
    """The global map, with the layers that fit. Without layers it is the local map itself."""
    layers = fitting(local, [layer for layer in layers if not layer.box.empty])
    if not layers:
        return local
    outer = _extent(local, layers)
    result = cropped(local, outer)
    cells = result.cells.copy()
    for layer in layers:
        view = cells[layer.box.shifted(-outer.top, -outer.left).slices()]
        np.copyto(view, layer.cells, where=(view == UNKNOWN))
    _close_walls(cells, local, layers, outer)
    return Grid(result.info, cells)


def _close_walls(cells: np.ndarray, local: Grid, layers: Sequence[Layer], outer: Box) -> None:
    """Rule 3 on the fused cells, in place."""
    inner = full_box(local.info).shifted(-outer.top, -outer.left).slices()
    free = np.zeros(cells.shape, bool)
    free[inner] = local.free
    unknown = np.ones(cells.shape, bool)
    unknown[inner] = local.cells == UNKNOWN
    dropped = np.zeros(cells.shape, np.uint8)
    for layer in layers:
        place = layer.box.shifted(-outer.top, -outer.left).slices()
        dropped[place] |= ((layer.cells >= OCCUPIED_FROM) & free[place]).astype(np.uint8)
    if dropped.any():
        border = cv2.dilate(dropped, np.ones((3, 3), np.uint8)).astype(bool)
        cells[border & unknown & (cells >= 0)] = OCCUPIED
