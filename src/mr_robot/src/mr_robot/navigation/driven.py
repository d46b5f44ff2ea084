"""Ground that the robot has driven over: a map in which a wall is drawn a cell too near closes no way that it came."""

import math
from typing import Dict, Tuple

import numpy as np

from mr_grid import GridInfo, Pose

SQUARE = 0.05  # m
SQUARES_KEPT = 20000  # squares, a kilometre of way; the oldest go first


class DrivenGround:
    """Squares of the map frame that the robot's middle has been in."""

    def __init__(self) -> None:
        self._squares: Dict[Tuple[int, int], None] = {}

    def add(self, pose: Pose) -> None:
        square = (math.floor(pose[0] / SQUARE), math.floor(pose[1] / SQUARE))
        self._squares.pop(square, None)
        self._squares[square] = None
        if len(self._squares) > SQUARES_KEPT:
            del self._squares[next(iter(self._squares))]

    def cells_of(self, info: GridInfo) -> np.ndarray:
        """Cells (row, column) of a grid, int64 (n, 2), in the squares and beside them, so that they hang together."""
        middles = SQUARE * (np.array(list(self._squares), float).reshape(-1, 2) + 0.5)
        beside = SQUARE * np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)], float)
        cells = info.cells_of((middles[:, None, :] + beside[None, :, :]).reshape(-1, 2))
        return cells[info.inside(cells)]
