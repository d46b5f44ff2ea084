"""Which transforms between robots were believed, when, and how right they were."""

from __future__ import annotations

import math
from typing import Any, Sequence

import numpy as np

from map_merger.agent import Agent
from map_merger.grid import Grid
from map_merger.transform import Transform
from mr_sim.pose import Pose, compose, inverse, normalized

WRONG_OFFSET = 0.25  # m anywhere in the overlap
WRONG_TURN = math.radians(2.0)


def known_box(grid: Grid) -> np.ndarray | None:
    """Corners (4, 2) in m, map frame, of the part of a map that is known; None if nothing is."""
    rows, columns = np.nonzero(grid.cells >= 0)
    if rows.size == 0:
        return None
    low = np.array([columns.min(), rows.min()]) * grid.info.resolution
    high = np.array([columns.max() + 1, rows.max() + 1]) * grid.info.resolution
    corners = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    return corners + np.array([grid.info.origin.x, grid.info.origin.y])


def largest_offset(believed: Transform, true: Transform, points: np.ndarray) -> float:
    """m by which the two transforms place one of the points (n, 2) differently, at most."""
    return float(np.hypot(*(believed.apply(points) - true.apply(points)).T).max())


class MergeLog:
    """`starts`: true start poses, so that the true transform between any two map frames is known."""

    def __init__(self, starts: Sequence[Pose], names: Sequence[str]) -> None:
        self._starts = dict(zip(names, starts))
        self._believed: dict[str, dict[str, Transform]] = {name: {} for name in names}
        self.entries: dict[str, list[dict[str, Any]]] = {name: [] for name in names}

    def look(self, robot: Any, agent: Agent, now: float) -> None:
        """Notes what has changed in the transforms of a robot's merger; later refinements count only for the error."""
        before, present = self._believed[robot.name], agent.transforms()
        for other in sorted(before.keys() - present.keys()):
            self.entries[robot.name].append({"with": other, "at": round(now, 3), "transform": None})
        for other, transform in present.items():
            if other not in before or _apart(before[other], transform):
                self.entries[robot.name].append(self._entry(robot.name, other, transform, agent, now))
                before = {**before, other: transform}
        self._believed[robot.name] = {name: before[name] for name in present}

    def _entry(self, robot: str, other: str, transform: Transform, agent: Agent, now: float) -> dict[str, Any]:
        true = Transform(*compose(inverse(self._starts[robot]), self._starts[other]))
        box = None if agent.local_map is None else known_box(agent.local_map)
        points = np.zeros((1, 2)) if box is None else transform.inverse().apply(box)
        offset = largest_offset(transform, true, points)
        turn = abs(normalized(transform.yaw - true.yaw))
        return {
            "with": other,
            "at": round(now, 3),
            "transform": [round(transform.x, 4), round(transform.y, 4), round(transform.yaw, 5)],
            "offset": round(offset, 4),
            "turn": round(turn, 5),
            "right": offset <= WRONG_OFFSET and turn <= WRONG_TURN,
        }


def _apart(first: Transform, second: Transform) -> bool:
    moved = math.hypot(first.x - second.x, first.y - second.y)
    return moved > 0.05 or abs(normalized(first.yaw - second.yaw)) > 0.01
