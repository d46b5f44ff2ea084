"""Ground that the robot has driven over: a map in which a wall is drawn a cell too near closes no way that it came."""

import math
from typing import Dict, Tuple

import numpy as np

from mr_grid import GridInfo, Pose

SQUARES_KEPT = 20000  # cells, a kilometre of way; the oldest go first


class DrivenGround:
    """Squares of the map frame, as large as cells of the map, that the robot's middle has been in."""

    def __init__(self) -> None:
        self._side = 0.0  # m
        self._squares: Dict[Tuple[int, int], None] = {}

    def add(self, pose: Pose, resolution: float) -> None:
        """`resolution`: m per cell of the present map."""
        if resolution != self._side:
            self._side, self._squares = resolution, {}
        square = (math.floor(pose[0] / resolution), math.floor(pose[1] / resolution))
        self._squares.pop(square, None)
        self._squares[square] = None
        if len(self._squares) > SQUARES_KEPT:
            del self._squares[next(iter(self._squares))]

    def cells_of(self, info: GridInfo) -> np.ndarray:
        """Cells (row, column) of a grid, int64 (n, 2), in the squares and beside them, so that they hang together."""
        middles = self._side * (np.array(list(self._squares), float).reshape(-1, 2) + 0.5)
        beside = self._side * np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)], float)
        cells = info.cells_of((middles[:, None, :] + beside[None, :, :]).reshape(-1, 2))
        return cells[info.inside(cells)]
