"""Robots in maps: obstacles where a robot has been are not walls.

Robots start side by side and meet later, and the map of each then holds the others as obstacles, until it looks there
again when they have left. Where robots are is told by their positions; a global map holds none. By the tracks of all
robots

- nothing stands within `RobotSize.inner` of where a robot's centre has been;
- a small obstacle by itself, close to the track of another robot whose own map shows nothing there, is that robot;
- so is what is closer still, also if joined to a wall, where another map shows floor and no map a wall.
"""

import math
from typing import Dict, Mapping

import numpy as np

from . import _surfaces
from .grid import Box
from .robot_size import RobotSize

_CONFIRMED = 0.25
"""Share of an obstacle that the robot's own map must hold for it to be a real one."""
_OFF = 2
"""Cells that two maps of the same wall may be apart."""


def reach(resolution: float, size: RobotSize) -> int:
    """Cells from a cell within which what maps know can make it a ghost."""
    return math.ceil(size.largest / resolution) + _OFF + 2


def effect(resolution: float, size: RobotSize) -> int:
    """Cells from a place within which cells can be ghosts by it."""
    return math.ceil((size.largest + size.near) / resolution) + 1


def possible(cells: np.ndarray, places: np.ndarray, box: Box, resolution: float, size: RobotSize) -> bool:
    """False if a robot that was at the places can be no obstacle of this map, int8 (rows, columns) of the box; places:
    row and column of the cells in which it was, int (n, 2)."""
    return _surfaces.may_be_ghost(cells, places, box.edges, _rules(resolution, size))


def without_ghosts(
    maps: Mapping[str, np.ndarray], places: Mapping[str, np.ndarray], box: Box, resolution: float, size: RobotSize
) -> Dict[str, np.ndarray]:
    """The maps, int8 of the box by the names of the robots that made them, without robots; those that hold none as they
    are. places: for each robot row and column of the cells in which it was, int (n, 2)."""
    numbers = {name: number for number, name in enumerate(maps)}
    tracks = [(numbers.get(robot, -1), cells) for robot, cells in sorted(places.items())]
    cleaned = _surfaces.without_ghosts(list(maps.values()), tracks, box.edges, _rules(resolution, size))
    return {name: cells if clean is None else clean for (name, cells), clean in zip(maps.items(), cleaned)}


def _rules(resolution: float, size: RobotSize) -> _surfaces.GhostRules:
    return _surfaces.GhostRules(resolution, size.inner, size.touching, size.near, size.largest, _CONFIRMED, _OFF)
