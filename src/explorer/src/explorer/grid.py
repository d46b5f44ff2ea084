"""Occupancy grids as exploration reads them: what counts as free, and what is in view."""

from dataclasses import dataclass
from functools import cached_property
from typing import Tuple

import numpy as np

from explorer._kernels import lines_are_clear
from explorer.errors import MapError
from mr_grid import FARTHEST, FREE, OccupancyGrid, is_place


@dataclass(frozen=True, eq=False)
class OccupancyMap(OccupancyGrid):
    """An occupancy grid: free below `FREE_BELOW`, -1 unknown, occupied from `OCCUPIED_FROM` on. Its cells lie along the
    axes of the map frame."""

    FREE_BELOW = 25
    OCCUPIED_FROM = 50

    def __post_init__(self) -> None:
        super().__post_init__()
        info, (x, y, yaw) = self.info, self.info.origin
        if not is_place(x, y):
            raise MapError(f"map origin is ({x}, {y}); it must be within {FARTHEST:g} m")
        if yaw:
            raise MapError("map origin is rotated; publish the map with an unrotated origin")
        if info.width < 1 or info.height < 1:
            raise MapError(f"map has {info.width} x {info.height} cells; it needs at least one")

    @cached_property
    def free(self) -> np.ndarray:
        """(height, width) bool array. Cells of middling occupancy are neither free nor unknown nor occupied."""
        return (self.cells >= FREE) & (self.cells < self.FREE_BELOW)

    @cached_property
    def occupied(self) -> np.ndarray:
        return self.cells >= self.OCCUPIED_FROM

    @cached_property
    def known_area(self) -> float:
        """m^2."""
        return int(np.count_nonzero(self.cells >= 0)) * self.info.resolution**2


def line_is_clear(blocked: np.ndarray, start: Tuple[int, int], end: Tuple[int, int]) -> bool:
    """True if no cell of the straight line between two cells of a bool array (rows, cols) is blocked; the two ends
    do not count. Cells outside the array count as blocked."""
    return bool(lines_are_clear(blocked, np.array([start]), np.array([end]))[0])
