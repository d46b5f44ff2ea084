"""Robots in maps: obstacles where a robot has been are not walls.

Robots start side by side and meet later, and the map of each then holds the others as obstacles. When the robot has
left, only who looks there again removes the ghost from the own map. By the tracks of all robots

- nothing stands within `BODY_M` of where a robot's centre has been;
- a small obstacle by itself, close to the track of another robot whose own map shows nothing there, is that robot;
- so is what is closer still, also if joined to a wall, where another map shows floor and no map a wall.
"""

import math
from typing import Dict, NamedTuple, Optional, Sequence

import cv2
import numpy as np

from .grid import FREE, OCCUPIED_FROM, Box
from .obstacles import obstacles_of
from .weighing import seen_through, square, walls_of

BODY_M = 0.1
"""Inner radius of the smallest robot in metres, less what a track is off."""
TOUCHING_M = 0.35
"""Metres from a robot's centre that its body can reach."""
NEAR_M = 0.45
"""Metres from a robot's centre within which an obstacle by itself is taken for the robot."""
LARGEST_M = 0.8
"""Largest extent in metres of such an obstacle."""
PRESENT_M = 0.8
"""Metres from a robot's present place in which the own map rightly holds it."""
_CONFIRMED = 0.25
"""Share of an obstacle that the robot's own map must hold for it to be a real one."""
_OFF = 2
"""Cells that two maps of the same wall may be apart."""


class Presence(NamedTuple):
    """Where one robot has been, as masks (uint8) of the cells within BODY_M, TOUCHING_M, NEAR_M, and PRESENT_M of its
    last place."""

    body: np.ndarray
    touching: np.ndarray
    near: np.ndarray
    present: np.ndarray


def reach(resolution: float) -> int:
    """Cells from a cell within which what maps know can make it a ghost."""
    return math.ceil(LARGEST_M / resolution) + _OFF + 2


def effect(resolution: float) -> int:
    """Cells from a place within which cells can be ghosts by it."""
    return math.ceil((LARGEST_M + PRESENT_M) / resolution) + 1


def presence(places: np.ndarray, resolution: float, box: Box) -> Presence:
    """Of a robot in the cells of `box`; places: row and column of the cells in which it was, int (n, 2), oldest first."""
    distance = _distance(places, math.ceil(NEAR_M / resolution), box) * resolution
    present = _distance(places[-1:], math.ceil(PRESENT_M / resolution), box) * resolution
    body, touching, near = ((distance <= radius).view(np.uint8) for radius in (BODY_M, TOUCHING_M, NEAR_M))
    return Presence(body, touching, near, (present <= PRESENT_M).view(np.uint8))


def _distance(places: np.ndarray, margin: int, box: Box) -> np.ndarray:
    """Cells from each cell of the box to the next of the places that are at most `margin` from the box."""
    outer = box.grown(margin)
    rows, columns = (places - (outer.top, outer.left)).T
    inside = (rows >= 0) & (columns >= 0) & (rows < outer.shape[0]) & (columns < outer.shape[1])
    if not inside.any():
        return np.full(box.shape, np.inf, np.float32)
    elsewhere = np.ones(outer.shape, np.uint8)
    elsewhere[rows[inside], columns[inside]] = 0
    distance = cv2.distanceTransform(elsewhere, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return distance[margin : margin + box.shape[0], margin : margin + box.shape[1]]


def without_ghosts(
    maps: Dict[str, np.ndarray], robots: Dict[str, Presence], resolution: float, own: str
) -> Dict[str, np.ndarray]:
    """The maps, int8 of equal shape by the names of the robots that made them, without robots.

    `own`: the robot that still sees the others where they stand, so these stay in its map. Maps without a robot in
    them are returned as they are.
    """
    near = [name for name, robot in robots.items() if robot.near.any()]
    if not near:
        return maps
    return {name: _cleaned(name, maps, robots, near, resolution, own) for name in maps}


def _cleaned(
    name: str,
    maps: Dict[str, np.ndarray],
    robots: Dict[str, Presence],
    near: Sequence[str],
    resolution: float,
    own: str,
) -> np.ndarray:
    cells = maps[name]
    ghosts = np.zeros(cells.shape, bool)
    for robot in near:
        left = (1 - robots[robot].present) if name == own != robot else np.uint8(1)
        ghosts |= (robots[robot].body & left).view(bool)
        if robot != name:
            ghosts |= _overrun(name, maps, robots[robot].touching & left)
            ghosts |= _alone(cells, robots[robot].near & left, maps.get(robot), resolution)
    ghosts &= cells >= OCCUPIED_FROM
    return np.where(ghosts, np.int8(FREE), cells) if ghosts.any() else cells


def _overrun(name: str, maps: Dict[str, np.ndarray], touching: np.ndarray) -> np.ndarray:
    """Cells in a robot's reach where another map shows floor and none a wall."""
    floor, wall = np.zeros_like(touching), np.zeros_like(touching)
    for other, cells in maps.items():
        if other != name:
            floor |= seen_through(cells, _OFF)
            wall |= walls_of(cells)
    return (touching & floor & ~cv2.dilate(wall, square(1))).view(bool)


def _alone(cells: np.ndarray, near: np.ndarray, witness: Optional[np.ndarray], resolution: float) -> np.ndarray:
    """Small obstacles by themselves whose middle is near the robot and which the robot itself did not see."""
    result = np.zeros(cells.shape, bool)
    obstacles = obstacles_of(cells >= OCCUPIED_FROM)
    # Not np.round, with which the cell would depend on where the window begins.
    rows, columns = np.floor(obstacles.centres + 0.5).astype(int).T
    suspects = (obstacles.areas > 0) & (obstacles.extents() * resolution <= LARGEST_M)
    suspects &= near[rows, columns].view(bool)
    if not suspects.any():
        return result
    if witness is not None:
        seen = cv2.dilate(walls_of(witness), square(_OFF)).ravel()[obstacles.cells]
        confirmed = np.bincount(obstacles.label_of, weights=seen, minlength=len(obstacles.areas))
        suspects &= confirmed < _CONFIRMED * obstacles.areas
    result.ravel()[obstacles.cells] = suspects[obstacles.label_of]
    return result
