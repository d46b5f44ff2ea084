"""A world as the measures take it: true walls, and what its robots are. Whoever simulates it makes this value."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable

import numpy as np

from mr_grid import OccupancyGrid, Pose

Polygon = tuple[tuple[float, float], ...]
"""Corners in m."""
RayCaster = Callable[[tuple[float, float], np.ndarray, float], np.ndarray]
"""Lengths (N,) in m of rays from a point (m) into directions (N,) (rad), up to a length in m, in the visible walls."""


@dataclass(frozen=True)
class TrueRobot:
    """`start`: world frame; `footprint`: in the robot's frame; `range_max`: of its farthest sensor, m, 0 without one;
    `arm`: m from the robot's centre to its outermost sensor; `top_speed`: m/s that its base allows."""

    start: Pose
    footprint: tuple[Polygon, ...]
    range_max: float
    arm: float
    top_speed: float


@dataclass(frozen=True, eq=False)
class TrueWorld:
    """`visible`: walls that sensors see; `solid`: what robots run into. Cells are 0 or 100, unturned, world frame."""

    visible: OccupancyGrid
    solid: OccupancyGrid
    cast: RayCaster
    robots: tuple[TrueRobot, ...]

    @property
    def range_max(self) -> float:
        """m, of the farthest sensor of all robots."""
        return max((robot.range_max for robot in self.robots), default=0.0)
