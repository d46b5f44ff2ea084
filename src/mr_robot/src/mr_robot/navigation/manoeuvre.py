"""Motions where there is little room: planned over x, y and heading, then followed."""

import math
from bisect import bisect_right
from typing import Optional, Tuple

import numpy as np

from mr_grid import Pose
from mr_robot import _navigation
from mr_robot.navigation.options import LEAST_TURN
from mr_robot.navigation.planner import Plan

GAIN = 2.0  # 1/s by which errors are made good
OVERTIME = 1.0  # s after the end in which the last error is made good


def plan_manoeuvre(
    way: Plan,
    pose: Pose,
    obstacles: np.ndarray,
    footprint: _navigation.Footprint,
    limits: _navigation.Limits,
    known: float,
    slack: float,
) -> Optional["Manoeuvre"]:
    """From a pose with little room on along the way, or to the nearest pose with room; None: nothing is better than to
    stay. `obstacles`: rows (x, y, margin, reaction time), all within `known` m of the pose. `slack`: m nearer than now
    that a robot which may touch something already may come to it."""
    agility = _navigation.Agility(limits)
    rows = _navigation.manoeuvre(
        way.cost,
        way.grid.cells,
        way.grid.resolution,
        way.grid.origin[:2],
        way.goal,
        pose,
        obstacles,
        footprint,
        agility,
        known,
        slack,
    )
    return Manoeuvre(rows) if len(rows) > 1 else None


class Manoeuvre:
    """Follows waypoints as a moving reference (Kanayama, Kimura, Miyazaki and Noguchi, A stable tracking control method
    for an autonomous mobile robot, 1990)."""

    def __init__(self, waypoints: np.ndarray) -> None:
        """`waypoints`: rows (x, y, yaw, direction, seconds), see manoeuvre.hpp."""
        self._rows = waypoints.tolist()
        self._times = [row[4] for row in self._rows]
        self._time = 0.0

    def velocity(self, pose: Pose, period: float) -> Optional[Tuple[float, float]]:
        """m/s and rad/s for the next `period`, s; None when the robot is there or does not get there."""
        if self._time >= self._times[-1] + OVERTIME:
            return None
        reference, linear, angular = self._reference()
        ahead, aside, turn = pose.between(reference)
        turn = math.remainder(turn, 2.0 * math.pi)
        behind = abs(ahead) > 2.0 * _navigation.TOUCHING or abs(turn) > 0.5 * LEAST_TURN
        if not behind and self._time >= self._times[-1]:
            return None
        # A robot that is elsewhere is waited for, at a tenth of the pace so that the end comes in any case.
        pace = 0.1 if behind else 1.0
        self._time += pace * period
        return (
            pace * linear * math.cos(turn) + GAIN * ahead,
            pace * (angular + GAIN**2 * linear * aside) + GAIN * turn,
        )

    def _reference(self) -> Tuple[Pose, float, float]:
        """Pose, m/s and rad/s at the present time."""
        index = bisect_right(self._times, self._time)
        if index >= len(self._rows):
            x, y, yaw = self._rows[-1][:3]
            return Pose(x, y, yaw), 0.0, 0.0
        before, after = self._rows[index - 1], self._rows[index]
        seconds = after[4] - before[4]
        share = (self._time - before[4]) / seconds
        x, y, yaw = (a + share * (b - a) for a, b in zip(before[:3], after[:3]))
        way = after[3] * math.dist(before[:2], after[:2])
        return Pose(x, y, yaw), way / seconds, (after[2] - before[2]) / seconds
