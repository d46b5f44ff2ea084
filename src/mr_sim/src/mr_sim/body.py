"""SLAM and navigation of one simulated robot in virtual time."""

from __future__ import annotations

import math
from contextlib import nullcontext
from typing import Callable, ContextManager, Mapping

import numpy as np

from mr_grid import OccupancyGrid, Pose
from mr_robot.navigation.engine import Navigator, Status
from mr_robot.navigation.options import NavigationError, NavigationOptions
from mr_robot.slam.engine import MAP_UPDATE_INTERVAL, LaserScan, Slam, SlamOptions
from mr_sim.control_cycle import ControlCycle
from mr_sim.world_description import RangerDescription

GoalEnd = Callable[[int, bool, str], None]
"""Number of a goal, whether it was reached, and why not."""

Span = Callable[[str], ContextManager[None]]
"""Measures what is done inside, under the name of a component."""


class Body:
    """Scans and odometry in; pose, maps and velocity commands out."""

    def __init__(
        self, name: str, ranger: RangerDescription, slam: SlamOptions, navigation: NavigationOptions, seed: int,
        span: Span = lambda _: nullcontext(),
    ) -> None:  # fmt: skip
        self.slam = Slam(slam)
        self.navigator = Navigator(navigation, name, seed)
        self.pose: Pose | None = None
        self._span = span
        self._cycle = ControlCycle(ranger, navigation.controller_period)
        self._geometry = (
            ranger.angle_min, ranger.angle_increment, ranger.range_min, ranger.range_max, ranger.mount,
        )  # fmt: skip
        self._map_at = -math.inf
        self._revision = 0
        self._goal: int | None = None
        self._rests = True
        self.on_goal_end: GoalEnd = lambda *_: None

    def scan_of(self, ranges: np.ndarray) -> LaserScan:
        """What the driver makes of the laser's ranges, m."""
        return LaserScan(ranges, *self._geometry)

    def locate(self, scan: LaserScan, odometry: Pose, now: float) -> Pose:
        """The robot's pose in its map frame, from a scan."""
        with self._span("slam"):
            pose = self.slam.process(scan, odometry, now).pose
        self._cycle.see(scan.ranges, odometry, now)
        self.pose = pose
        return pose

    def new_map(self, now: float) -> OccupancyGrid | None:
        """The local map if there is a new one to hand out."""
        if now - self._map_at < MAP_UPDATE_INTERVAL or self.slam.revision == self._revision:
            return None
        self._map_at, self._revision = now, self.slam.revision
        with self._span("slam"):
            own = self.slam.map()
        with self._span("navigation"):
            self.navigator.set_own_map(own, now)
        return own

    def steer(self, odometry: Pose, now: float) -> tuple[float, float] | None:
        """Velocities in m/s and rad/s from now on; None where it is not yet time for others."""
        if not self._cycle.due(now):
            return None
        if self._goal is None and self._rests:
            return 0.0, 0.0
        with self._span("navigation"):
            command = self.navigator.step(now, self.slam.pose_at(odometry), self._cycle.scan(odometry))
        self._rests = command.linear == 0.0 and command.angular == 0.0
        if self._goal is not None and command.status in (Status.SUCCEEDED, Status.ABORTED):
            goal, self._goal = self._goal, None
            self.on_goal_end(goal, command.status is Status.SUCCEEDED, command.text or "goal reached")
        return command.linear, command.angular

    def set_map(self, grid: OccupancyGrid) -> None:
        """The merged map, on which paths are planned."""
        with self._span("navigation"):
            self.navigator.set_map(grid)

    def set_others(self, positions: Mapping[str, tuple[float, float]], now: float) -> None:
        with self._span("navigation"):
            self.navigator.set_others(positions, now)

    def set_goal(self, goal_id: int, pose: Pose, now: float) -> None:
        """A former goal is forgotten without a report, as the action does."""
        self._goal = goal_id
        try:
            self.navigator.set_goal(pose, now)
        except NavigationError as error:
            self._goal = None
            self.navigator.cancel()
            self.on_goal_end(goal_id, False, str(error))

    def cancel(self) -> None:
        self._goal = None
        self.navigator.cancel()
