"""A floor while it is drawn, in metres."""

import math
from typing import Tuple

import numpy as np

from .plan import FloorPlan, Motion

RESOLUTION = 0.05
WALL_M = 0.1


class Floor:
    """A solid or empty rectangle of `length` x `depth` metres with an outer wall, into which rectangles are drawn."""

    def __init__(self, length: float, depth: float, solid: bool = False) -> None:
        self.length, self.depth = length, depth
        shape = math.ceil(depth / RESOLUTION), math.ceil(length / RESOLUTION)
        self.walls = np.full(shape, solid)
        self.furniture = np.zeros(shape, bool)

    def wall(self, left: float, bottom: float, right: float, top: float) -> None:
        """Solid from corner to corner."""
        self.walls[self._cells(left, bottom, right, top)] = True

    def line(self, left: float, bottom: float, right: float, top: float) -> None:
        """A wall of the usual thickness from point to point, along an axis."""
        self.wall(left, bottom, max(right, left + WALL_M), max(top, bottom + WALL_M))

    def open(self, left: float, bottom: float, right: float, top: float) -> None:
        """Nothing stands from corner to corner."""
        self.walls[self._cells(left, bottom, right, top)] = False
        self.furniture[self._cells(left, bottom, right, top)] = False

    def furnish(self, left: float, bottom: float, right: float, top: float) -> None:
        """Furniture from corner to corner, where there is no wall."""
        cells = self._cells(left, bottom, right, top)
        self.furniture[cells] |= ~self.walls[cells]

    def has_wall(self, left: float, bottom: float, right: float, top: float) -> bool:
        """True if a wall stands anywhere between the corners."""
        return bool(self.walls[self._cells(left, bottom, right, top)].any())

    def plan(self, aliases: Tuple[Motion, ...] = ()) -> FloorPlan:
        """The floor as it is now, inside an outer wall of two cells."""
        walls = self.walls | self.furniture
        outer = np.ones_like(walls)
        outer[2:-2, 2:-2] = False
        return FloorPlan(walls | outer, RESOLUTION, aliases, self.furniture & ~outer)

    def _cells(self, left: float, bottom: float, right: float, top: float) -> Tuple[slice, slice]:
        left, bottom, right, top = (max(0, round(value / RESOLUTION)) for value in (left, bottom, right, top))
        return slice(bottom, top), slice(left, right)
