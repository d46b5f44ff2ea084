"""What several maps on one lattice say together about each cell.

Two maps of one wall lie up to `SAME_WALL` cells apart: by drift, by the error of the transform, by rounding to cells.
So

1. what more maps hold for wall than for floor, or as many, is wall;
2. a wall goes where another map saw floor and nothing but floor within `SEEN_THROUGH` cells (an open door, a robot that
   has left); floor beside an own wall or unknown cells does not remove it;
3. a wall beside one that is there already is the same wall and not drawn again, unless it closes off floor, or joins
   the one that is there to its own continuation;
4. floor that lies pinched between a wall that is there and the own wall is an error of alignment, no space;
5. a wall that may not be drawn on local floor closes the unknown cells beside it: what the local map saw of the floor
   in front of a wall must not open it;
6. unknown gaps up to two cells wide between maps are closed: by wall beside walls, by floor between floor.

What a cell becomes depends on the cells within `reach` of it only, so that a part can be computed by itself.
"""

from typing import List, Sequence, Tuple

import cv2
import numpy as np

from .grid import FREE, OCCUPIED, OCCUPIED_FROM, UNKNOWN

SAME_WALL = 2
SEEN_THROUGH = 3

_CROSS = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], np.uint8)


def reach(foreign: int) -> int:
    """Cells from a cell within which what `foreign` maps know can change it."""
    return SEEN_THROUGH + 2 * SAME_WALL * foreign + 7


def square(radius: int) -> np.ndarray:
    """Kernel of all cells within `radius` cells."""
    return np.ones((2 * radius + 1, 2 * radius + 1), np.uint8)


def walls_of(cells: np.ndarray) -> np.ndarray:
    """uint8, 1 where an obstacle is."""
    return (cells >= OCCUPIED_FROM).view(np.uint8)


def floor_of(cells: np.ndarray) -> np.ndarray:
    """uint8, 1 where a cell is free."""
    return ((cells >= 0) & (cells < OCCUPIED_FROM)).view(np.uint8)


def seen_through(cells: np.ndarray, radius: int = SEEN_THROUGH) -> np.ndarray:
    """uint8, 1 where all cells within `radius` are free; also at the border of the array."""
    return cv2.erode(floor_of(cells), square(radius))


def weighed(local: np.ndarray, foreign: Sequence[np.ndarray], locked: bool) -> np.ndarray:
    """The global map, int8 (rows, columns), of the local one and others of the same shape, which count in their order.

    `locked`: known local cells stay as they are; otherwise the local map is the first among equals.
    """
    open_floor = np.zeros(local.shape, np.uint8)
    for cells in (local, *foreign):
        open_floor |= seen_through(cells)
    layers = [_without_walls(each, open_floor) for each in (foreign if locked else (local, *foreign))]
    kept = (local != UNKNOWN) if locked else np.zeros(local.shape, bool)
    votes, disputed = _votes(layers, local.shape)
    solid = disputed & (votes >= 0)
    if not locked:
        solid |= (local >= OCCUPIED_FROM) & (votes >= 0)
    cells = np.where(kept, local, np.where(solid, np.int8(OCCUPIED), np.int8(UNKNOWN)))
    kept_floor = (kept & (local < OCCUPIED_FROM)).view(np.uint8)
    refused = np.zeros(local.shape, np.uint8)
    for layer in layers:
        refused |= _add(cells, layer, kept_floor)
    if locked:
        _close_beside(cells, refused, local == UNKNOWN)
        for layer in layers:
            _close_beside(cells, walls_of(layer) & kept_floor, cells == UNKNOWN)
    _close_gaps(cells, [local, *foreign], kept)
    return cells


def _without_walls(cells: np.ndarray, where: np.ndarray) -> np.ndarray:
    return np.where((cells >= OCCUPIED_FROM) & where.view(bool), np.int8(FREE), cells)


def _votes(layers: Sequence[np.ndarray], shape: Tuple[int, ...]) -> Tuple[np.ndarray, np.ndarray]:
    """How many more maps hold wall than floor, int8, and whether some hold the one and some the other, bool."""
    votes, floor, wall = np.zeros(shape, np.int8), np.zeros(shape, np.uint8), np.zeros(shape, np.uint8)
    for layer in layers:
        walls_here, floor_here = walls_of(layer), floor_of(layer)
        votes += walls_here.view(np.int8) - floor_here.view(np.int8)
        wall |= walls_here
        floor |= floor_here
    return votes, (wall & floor).view(bool)


def _add(cells: np.ndarray, layer: np.ndarray, kept_floor: np.ndarray) -> np.ndarray:
    """Draws the layer into the cells; returns its walls that may not be drawn, uint8."""
    present, wall, unknown = walls_of(cells), walls_of(layer), cells == UNKNOWN
    floor = floor_of(layer) & unknown.view(np.uint8)
    floor &= ~_pinched(present, wall)
    beside = cv2.dilate(present, square(SAME_WALL))
    alone = wall & ~beside
    # Reaches over the other wall's tolerance, so that the two hang together.
    joint = wall & cv2.dilate(alone, square(SAME_WALL))
    any_floor = floor_of(cells) | floor
    closing = wall & cv2.dilate(any_floor, _CROSS) & unknown.view(np.uint8)
    drawn = (joint | closing) & ~present
    refused = drawn & kept_floor
    cells[floor.view(bool)] = FREE
    cells[(drawn & ~kept_floor).view(bool)] = OCCUPIED
    return refused


def _pinched(present: np.ndarray, wall: np.ndarray) -> np.ndarray:
    """uint8, 1 between a wall that is there and one of the layer, each within SAME_WALL cells, on opposite sides."""
    result = np.zeros_like(wall)
    for axis in (0, 1):
        before, after = _side(axis, first=True), _side(axis, first=False)
        result |= cv2.dilate(present, before) & cv2.dilate(wall, after)
        result |= cv2.dilate(present, after) & cv2.dilate(wall, before)
    return result


def _side(axis: int, first: bool) -> np.ndarray:
    """Kernel of the SAME_WALL cells on one side along an axis."""
    line = np.zeros(2 * SAME_WALL + 1, np.uint8)
    line[:SAME_WALL] = 1
    line = line if first else line[::-1]
    return np.ascontiguousarray(line.reshape((-1, 1) if axis == 0 else (1, -1)))


def _close_beside(cells: np.ndarray, refused: np.ndarray, where: np.ndarray) -> None:
    """Obstacles in those cells of `where` (bool) that are beside a refused wall."""
    if refused.any():
        cells[cv2.dilate(refused, square(1)).view(bool) & where] = OCCUPIED


def _close_gaps(cells: np.ndarray, maps: List[np.ndarray], kept: np.ndarray) -> None:
    gaps = _gaps(cells != UNKNOWN)
    if not gaps.any():
        return
    for each in maps:
        # What one robot by itself did not see between what it saw is no seam.
        gaps &= ~_gaps(each != UNKNOWN)
    gaps &= cv2.dilate(floor_of(cells), square(1))
    solid = gaps & cv2.dilate(walls_of(cells), square(1))
    cells[gaps.view(bool)] = FREE
    cells[solid.view(bool)] = OCCUPIED


def _gaps(known: np.ndarray) -> np.ndarray:
    """uint8, 1 in unknown gaps up to two cells wide."""
    seen = known.view(np.uint8)
    return cv2.morphologyEx(seen, cv2.MORPH_CLOSE, square(1)) & (seen ^ 1)
