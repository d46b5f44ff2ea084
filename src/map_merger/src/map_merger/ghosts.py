"""Robots in maps: obstacles where a robot has been are not walls.

Robots start side by side and meet later, and the map of each then holds the others as obstacles, until it looks there
again when they have left. Where robots are is told by their positions; a global map holds none. By the tracks of all
robots

- nothing stands within `BODY_M` of where a robot's centre has been;
- a small obstacle by itself, close to the track of another robot whose own map shows nothing there, is that robot;
- so is what is closer still, also if joined to a wall, where another map shows floor and no map a wall.
"""

import math
from typing import Dict, Mapping

import numpy as np

from . import _surfaces
from .grid import Box

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


def reach(resolution: float) -> int:
    """Cells from a cell within which what maps know can make it a ghost."""
    return math.ceil(LARGEST_M / resolution) + _OFF + 2


def effect(resolution: float) -> int:
    """Cells from a place within which cells can be ghosts by it."""
    return math.ceil((LARGEST_M + NEAR_M) / resolution) + 1


def possible(cells: np.ndarray, places: np.ndarray, box: Box, resolution: float) -> bool:
    """False if a robot that was at the places can be no obstacle of this map, int8 (rows, columns) of the box; places:
    row and column of the cells in which it was, int (n, 2)."""
    return _surfaces.may_be_ghost(cells, places, box.edges, _rules(resolution))


def without_ghosts(
    maps: Mapping[str, np.ndarray], places: Mapping[str, np.ndarray], box: Box, resolution: float
) -> Dict[str, np.ndarray]:
    """The maps, int8 of the box by the names of the robots that made them, without robots; those that hold none as they
    are. places: for each robot row and column of the cells in which it was, int (n, 2)."""
    numbers = {name: number for number, name in enumerate(maps)}
    tracks = [(numbers.get(robot, -1), cells) for robot, cells in sorted(places.items())]
    cleaned = _surfaces.without_ghosts(list(maps.values()), tracks, box.edges, _rules(resolution))
    return {name: cells if clean is None else clean for (name, cells), clean in zip(maps.items(), cleaned)}


def _rules(resolution: float) -> _surfaces.GhostRules:
    return _surfaces.GhostRules(resolution, BODY_M, TOUCHING_M, NEAR_M, LARGEST_M, _CONFIRMED, _OFF)
