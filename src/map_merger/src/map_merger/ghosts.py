"""Robots in maps: obstacles where a robot has been are not walls.

Robots start side by side and meet later, and the map of each then holds the others as obstacles, until it looks there
again when they have left. Where robots are is told by their positions; a global map holds none. By the tracks of all
robots

- nothing stands within `BODY_M` of where a robot's centre has been;
- a small obstacle by itself, close to the track of another robot whose own map shows nothing there, is that robot;
- so is what is closer still, also if joined to a wall, where another map shows floor and no map a wall.
"""

import math
from typing import Dict, NamedTuple, Sequence, Tuple

import cv2
import numpy as np

from . import _surfaces
from .grid import FREE, OCCUPIED_FROM, Box
from .obstacles import Obstacles, obstacles_of
from .weighing import seen_through, square, walls_of

BODY_M = 0.1
"""Inner radius of the smallest robot in metres, less what a track is off."""
TOUCHING_M = 0.35
"""Metres from a robot's centre that its body can reach."""
NEAR_M = 0.45
"""Metres from a robot's centre within which an obstacle by itself is taken for the robot."""
LARGEST_M = 0.8
"""Largest extent in metres of such an obstacle."""
_CONFIRMED = 0.25
"""Share of an obstacle that the robot's own map must hold for it to be a real one."""
_OFF = 2
"""Cells that two maps of the same wall may be apart."""


class Presence(NamedTuple):
    """Where one robot has been, as masks (uint8) of the cells within BODY_M, TOUCHING_M and NEAR_M."""

    body: np.ndarray
    touching: np.ndarray
    near: np.ndarray


def reach(resolution: float) -> int:
    """Cells from a cell within which what maps know can make it a ghost."""
    return math.ceil(LARGEST_M / resolution) + _OFF + 2


def effect(resolution: float) -> int:
    """Cells from a place within which cells can be ghosts by it."""
    return math.ceil((LARGEST_M + NEAR_M) / resolution) + 1


def presence(places: np.ndarray, resolution: float, box: Box) -> Presence:
    """Of a robot in the cells of `box`; places: row and column of the cells in which it was, int (n, 2)."""
    edges = (box.top, box.left, box.bottom, box.right)
    squares = _surfaces.squares_to(places, edges, math.ceil(NEAR_M / resolution))
    body, touching, near = (
        (squares <= (radius / resolution) ** 2).view(np.uint8) for radius in (BODY_M, TOUCHING_M, NEAR_M)
    )
    return Presence(body, touching, near)


def possible(cells: np.ndarray, robot: Presence, resolution: float) -> bool:
    """False if the robot can be no obstacle of this map."""
    walls = walls_of(cells)
    if (walls & robot.touching).any():
        return True
    obstacles = obstacles_of(walls.view(bool))
    return bool((_small(obstacles, resolution) & _at_middles(obstacles, robot.near)).any())


def _small(obstacles: Obstacles, resolution: float) -> np.ndarray:
    return (obstacles.areas > 0) & (obstacles.extents() * resolution <= LARGEST_M)


def _at_middles(obstacles: Obstacles, mask: np.ndarray) -> np.ndarray:
    # Not np.round, with which the cell would depend on where the window begins.
    rows, columns = np.floor(obstacles.centres + 0.5).astype(int).T
    return mask[rows, columns].view(bool)


class _Seen(NamedTuple):
    """What a map says about others' obstacles, uint8: floor all around, walls within one and within _OFF cells."""

    floor: np.ndarray
    beside_wall: np.ndarray
    near_wall: np.ndarray


def _seen(cells: np.ndarray) -> _Seen:
    walls = walls_of(cells)
    return _Seen(seen_through(cells, _OFF), cv2.dilate(walls, square(1)), cv2.dilate(walls, square(_OFF)))


def without_ghosts(
    maps: Dict[str, np.ndarray], robots: Dict[str, Presence], resolution: float
) -> Dict[str, np.ndarray]:
    """The maps, int8 of equal shape by the names of the robots that made them, without robots; those that hold none as
    they are."""
    robots = {name: robot for name, robot in robots.items() if robot.near.any()}
    if not robots:
        return maps
    seen = {name: _seen(cells) for name, cells in maps.items()}
    return {name: _cleaned(name, cells, seen, robots, resolution) for name, cells in maps.items()}


def _cleaned(
    name: str, cells: np.ndarray, seen: Dict[str, _Seen], robots: Dict[str, Presence], resolution: float
) -> np.ndarray:
    others = [robot for robot in robots if robot != name]
    ghosts = _any_of([robot.body for robot in robots.values()], cells.shape)
    touching = _any_of([robots[other].touching for other in others], cells.shape)
    if touching.any():
        floor = _any_of([each.floor for other, each in seen.items() if other != name], cells.shape)
        wall = _any_of([each.beside_wall for other, each in seen.items() if other != name], cells.shape)
        ghosts |= touching & floor & (wall ^ 1)
    ghosts = ghosts.view(bool)
    if others:
        ghosts |= _alone(cells, {other: robots[other].near for other in others}, seen, resolution)
    ghosts &= cells >= OCCUPIED_FROM
    return np.where(ghosts, np.int8(FREE), cells) if ghosts.any() else cells


def _any_of(masks: Sequence[np.ndarray], shape: Tuple[int, ...]) -> np.ndarray:
    result = np.zeros(shape, np.uint8)
    for mask in masks:
        result |= mask
    return result


def _alone(cells: np.ndarray, near: Dict[str, np.ndarray], seen: Dict[str, _Seen], resolution: float) -> np.ndarray:
    """Small obstacles by themselves whose middle is near a robot that did not see them itself, bool."""
    result = np.zeros(cells.shape, bool)
    obstacles = obstacles_of(cells >= OCCUPIED_FROM)
    small = _small(obstacles, resolution)
    ghost = np.zeros(small.shape, bool)
    for robot, mask in near.items():
        suspects = small & _at_middles(obstacles, mask)
        if suspects.any() and robot in seen:
            held = seen[robot].near_wall.ravel()[obstacles.cells]
            confirmed = np.bincount(obstacles.label_of, weights=held, minlength=len(small))
            suspects &= confirmed < _CONFIRMED * obstacles.areas
        ghost |= suspects
    result.ravel()[obstacles.cells] = ghost[obstacles.label_of]
    return result
