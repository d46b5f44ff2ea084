"""What the figures of a mission mean, as functions on arrays. Definitions: docs/measures.md.

A map is placed in the world by the robot's true start pose, because a local map has its origin where the robot began.
All positions in metres, angles in radians, times in simulated seconds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mr_grid import OccupancyGrid, Pose

if TYPE_CHECKING:
    from mr_measures.truth import Truth  # slow to import; many processes need the limits alone

FREE_BELOW = 50  # an occupancy value from 0 to this (exclusive) is explored free space
OCCUPIED_FROM = 65  # an occupancy value from this on is a wall
WALL_TOLERANCE = 0.15  # m: an occupied cell farther from a true wall than this is a wrong wall
_ROUNDING = 1e-6  # m: cells and walls on lattices of 0.05 m lie just that tolerance apart by the thousand
MOVING_SPEED, MOVING_TURN = 0.05, 0.1  # m/s, rad/s: above either a robot is moving


def coverage(truth: Truth, occupancy: OccupancyGrid, start: Pose) -> float:
    """Share of the reference free cells that the map knows; `start`: the robot's true start pose."""
    if len(truth.reference) == 0:
        raise ValueError("the world has no reference cells: no robot can move in it")
    values = occupancy.values_at(start.apply_inverse(truth.reference))
    return float((values >= 0).mean())


def wrong_walls(truth: Truth, occupancy: OccupancyGrid, start: Pose) -> float:
    """Share of the map's occupied cells that are no true wall; 0 for a map without occupied cells."""
    occupied = occupancy.info.centres_of(np.argwhere(occupancy.cells >= OCCUPIED_FROM))
    if len(occupied) == 0:
        return 0.0
    return float((truth.wall_distance(start.apply(occupied)) > WALL_TOLERANCE + _ROUNDING).mean())


def explored_free_cells(occupancy: OccupancyGrid) -> int:
    """P_n of the map error."""
    return int(((occupancy.cells >= 0) & (occupancy.cells < FREE_BELOW)).sum())


def map_error(explored_free_cells: int, reference: float) -> float:
    """e in percent (paper VII-A): explored free cells against P_ref, signed."""
    if not reference > 0.0:
        raise ValueError(f"the reference must be positive, not {reference:g}")
    return (explored_free_cells / reference - 1.0) * 100.0


def overlap_between_robots(explored: Sequence[np.ndarray]) -> float:
    """Sum of what each robot explored itself over their union, minus 1; `explored`: bool masks of one shape."""
    union = np.logical_or.reduce(list(explored)).sum()
    return float(sum(int(mask.sum()) for mask in explored) / union - 1.0) if union else 0.0


def distance_driven(records: np.ndarray) -> float:
    """Metres driven according to a robot's truth trace (`motion.Trace.robots`)."""
    return float(np.hypot(np.diff(records["x"]), np.diff(records["y"])).sum())


def moving_share(records: np.ndarray, begin: float, end: float) -> float:
    """Share of the time with a task that the robot moves: from `begin`, the start of the mission, to `end`, when this
    robot has finished its exploration."""
    task = records[(records["time"] > begin) & (records["time"] <= end)]
    if len(task) == 0:
        return 0.0
    return float(((np.abs(task["v"]) > MOVING_SPEED) | (np.abs(task["w"]) > MOVING_TURN)).mean())


@dataclass(frozen=True)
class Collisions:
    """Contacts of a robot: a run of steps in which it was blocked by the same kind of thing is one contact."""

    with_walls: int
    with_robots: int
    times: tuple[float, ...]  # when each began

    @property
    def total(self) -> int:
        return self.with_walls + self.with_robots


def collisions(records: np.ndarray) -> Collisions:
    """Collisions of a robot according to its truth trace.

    The simulator stops a robot before its footprint would overlap something, so each such stop counts as a collision.
    """
    contact = records["collision"].astype(int)
    begins = np.flatnonzero((contact != 0) & (contact != np.concatenate([[0], contact[:-1]])))
    kinds: list[int] = [int(kind) for kind in contact[begins]]
    return Collisions(kinds.count(1), kinds.count(2), tuple(float(t) for t in records["time"][begins]))


def stalled_time(records: np.ndarray) -> float:
    """Seconds in which the simulator held the robot back."""
    step = float(np.median(np.diff(records["time"]))) if len(records) > 1 else 0.0
    return float(np.count_nonzero(records["stalled"])) * step
