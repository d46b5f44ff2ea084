"""Drives along a way; where that cannot be driven ahead, a manoeuvre leads on."""

import math
from functools import lru_cache
from typing import Callable, Optional

import numpy as np

from mr_grid import Pose
from mr_robot import _navigation
from mr_robot.navigation.command import Velocity
from mr_robot.navigation.manoeuvre import Manoeuvre, plan_manoeuvre
from mr_robot.navigation.motion import STOP, Ahead, Motion, bare
from mr_robot.navigation.options import LEAST_TURN, NavigationOptions
from mr_robot.navigation.planner import Plan
from mr_robot.navigation.surroundings import Hazards

SLOWEST_PACE = 0.25  # of a manoeuvre where a faster one would touch something


class Follower:
    def __init__(self, motion: Motion, options: NavigationOptions) -> None:
        self.gained_room = False  # whether a manoeuvre ended in this step
        self._motion = motion
        self._options = options
        self._manoeuvre: Optional[Manoeuvre] = None
        self._planned_at = -math.inf

    def drop_manoeuvre(self) -> None:
        self._manoeuvre = None

    def plan_anew(self) -> None:
        """Drops the manoeuvre, and another may be planned at once."""
        self._manoeuvre, self._planned_at = None, -math.inf

    def follow(
        self,
        now: float,
        way: Plan,
        pose: Pose,
        hazards: Hazards,
        stuck: bool,
        slack: float = _navigation.SLACK,
    ) -> Optional[Velocity]:
        """None where nothing is safe. `stuck`: whether the way does not lead on although nothing is in the way.
        `slack`: m nearer than now that a manoeuvre may lead to what the robot may touch already."""
        tight = bare(hazards.obstacles, self._options.obstacle_margin)
        ahead = lru_cache(maxsize=None)(lambda: self._motion.along(way, pose, hazards.obstacles))
        self.gained_room = False
        wanted = self._manoeuvre is None and self._wants_manoeuvre(now, way, pose, tight, stuck, ahead)
        if wanted or self._manoeuvre is not None:
            tight = np.concatenate([tight, bare(hazards.followers(), self._options.obstacle_margin)])
        if wanted and abs(self._motion.velocity[0]) > self._motion.agility.linear:
            # It would be elsewhere before it drives as planned.
            return self._motion.brake_clear(self._motion.towards(STOP), pose, tight)
        if wanted:
            self._planned_at = now
            self._manoeuvre = plan_manoeuvre(
                way, pose, tight, self._motion.footprint, self._motion.limits, self._options.reach, slack
            )
        if self._manoeuvre is not None:
            target = self._manoeuvre.velocity(pose, self._options.controller_period)
            if target is not None:
                velocity = self._slowed(pose, tight, target, slack)
                if velocity is None:
                    self.plan_anew()
                return self._motion.towards(velocity or STOP)
            self._manoeuvre = None
            self.gained_room = True
        return ahead().velocity

    def _slowed(self, pose: Pose, tight: np.ndarray, target: Velocity, slack: float) -> Optional[Velocity]:
        """The target, as slow as it has to be to be clear: what was planned ends sooner than what is looked at. None
        where it touches something at the slowest pace, too."""
        slack = max(slack, 0.5 * _navigation.TOUCHING)  # poses and scans are no more exact than that
        pace = 1.0
        while pace >= SLOWEST_PACE:
            velocity = (pace * target[0], pace * target[1])
            if self._motion.is_clear(pose, tight, velocity, slack=slack):
                return velocity
            pace *= 0.5
        return None

    def _wants_manoeuvre(
        self, now: float, way: Plan, pose: Pose, tight: np.ndarray, stuck: bool, ahead: Callable[[], Ahead]
    ) -> bool:
        if now - self._planned_at < self._options.plan_period:
            return False
        if stuck:
            return True
        if _navigation.has_room_to_turn(pose, tight, self._motion.footprint):
            return False
        if _navigation.clearance(pose, tight, self._motion.footprint) < _navigation.TOUCHING:
            return True
        off = _navigation.turn_wanted(way.cost, way.grid.resolution, way.grid.origin[:2], way.goal, pose)
        return abs(off) > LEAST_TURN and not ahead().gets_on
