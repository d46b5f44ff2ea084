"""What the body and its motors can do next.

Among the motions that the robot can make in the next period (Fox, Burgard and Thrun, The dynamic window approach to
collision avoidance, 1997), the one after which the plan's cost to go leaves the least time.
"""

from typing import NamedTuple, Optional

import numpy as np

from mr_grid import Pose
from mr_robot import _navigation
from mr_robot.navigation.command import Velocity
from mr_robot.navigation.options import PROGRESS, NavigationOptions, Scan
from mr_robot.navigation.planner import Plan

LOOK_AHEAD = 0.5  # m that a robot drives before it is where it has looked: it turns no sharper than it sees
STOP: Velocity = (0.0, 0.0)


class Ahead(NamedTuple):
    """What drives along a way best."""

    velocity: Optional[Velocity]  # None where nothing is safe, not even to brake gently
    gets_on: bool  # whether it leads nearer to the way's goal


class Motion:
    """Has the velocity commanded last. `obstacles`: rows (x, y, margin, reaction time) in the map frame."""

    def __init__(self, options: NavigationOptions) -> None:
        self.velocity = STOP
        self.footprint = options.footprint
        self._options = options
        self.limits = _navigation.Limits(
            options.max_linear_velocity,
            options.max_angular_velocity,
            options.linear_acceleration,
            options.angular_acceleration,
        )
        self.agility = _navigation.Agility(self.limits)

    def see(self, scan: Scan) -> None:
        """No bend is sharper than the robot can look into."""
        self.limits.curvature = 2.0 * scan.half_view / LOOK_AHEAD

    def along(self, way: Plan, pose: Pose, obstacles: np.ndarray) -> Ahead:
        horizon = _navigation.Horizon(self._options.horizon)
        tolerance = self._options.xy_goal_tolerance
        horizon.goal_radius = max(tolerance - _navigation.TOUCHING, 0.5 * tolerance)
        found, linear, angular, gained, _ = _navigation.choose_velocity(
            way.cost, way.grid.resolution, way.grid.origin[:2], way.goal, pose, self.velocity, obstacles,
            self.limits, self.footprint, horizon, self._options.controller_period,
        )  # fmt: skip
        gets_on = found and gained * self._options.max_linear_velocity > PROGRESS
        return Ahead((linear, angular) if found else None, gets_on)

    def is_clear(
        self,
        pose: Pose,
        obstacles: np.ndarray,
        target: Velocity,
        duration: float = _navigation.RAMP,
        slack: float = _navigation.SLACK,
    ) -> bool:
        """`slack`: m nearer than now that a robot which may touch something already may come to it."""
        horizon = _navigation.Horizon(duration)
        horizon.slack = slack
        return _navigation.is_clear(pose, self.velocity, target, obstacles, self.limits, self.footprint, horizon)

    def towards(self, target: Velocity) -> Velocity:
        """As near to it as accelerations allow."""
        period = self._options.controller_period
        most = (self._options.linear_acceleration * period, self._options.angular_acceleration * period)
        linear, angular = (v + min(max(t - v, -m), m) for v, t, m in zip(self.velocity, target, most))
        return linear, angular

    def brake(self) -> Velocity:
        self.velocity = self.towards(STOP)
        return self.velocity

    def brake_clear(self, velocity: Velocity, pose: Pose, obstacles: np.ndarray) -> Velocity:
        """Of a robot that brakes on the curve that it was on: at once where that touches something."""
        tight = bare(obstacles, self._options.obstacle_margin)
        self.velocity = velocity
        if not self.is_clear(pose, tight, STOP, self._options.braking_time):
            self.velocity = STOP
        return self.velocity


def bare(obstacles: np.ndarray, margin: float) -> np.ndarray:
    """Rows (x, y, margin, reaction time) with `margin`, m, less: as near as the body can come. At speed what moves is
    kept away from all the same."""
    rows = obstacles.copy()
    rows[:, 2] = np.maximum(rows[:, 2] - margin, 0.0)
    return rows
