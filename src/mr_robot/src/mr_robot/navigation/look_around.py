"""A robot that sees little turns once on the spot before it drives: what its wheels lose on the first metres would
shift the rest of its map, for too little of what it sees then has been seen from the start."""

import math
from typing import Optional

import numpy as np

from mr_grid import Pose
from mr_robot.navigation.command import Velocity
from mr_robot.navigation.motion import Motion, bare
from mr_robot.navigation.options import AT_REST, NavigationOptions, Scan
from mr_robot.platforms.parameters import NARROW_VIEW

RATE = 1.0  # rad/s


class LookAround:
    def __init__(self, motion: Motion, options: NavigationOptions) -> None:
        self._motion, self._options = motion, options
        self._rate = min(RATE, options.max_angular_velocity)
        self._over = not options.look_around
        self._turned = self._spent = 0.0  # rad, s
        self._yaw: Optional[float] = None  # in the step before

    def velocity(self, pose: Pose, scan: Scan, obstacles: np.ndarray) -> Optional[Velocity]:
        """Once per step of a robot with a goal; None when it need not turn, has done so, or cannot."""
        if self._over:
            return None
        if self._yaw is not None:
            self._turned += math.remainder(pose[2] - self._yaw, 2.0 * math.pi)
        self._yaw = pose[2]
        self._spent += self._options.controller_period
        tight = bare(obstacles, self._options.obstacle_margin)
        self._over = (
            2.0 * scan.half_view >= NARROW_VIEW
            or self._turned >= 2.0 * math.pi
            or self._spent > 2.0 * math.pi / self._rate + AT_REST
            or not self._motion.is_clear(pose, tight, (0.0, self._rate))
        )
        return None if self._over else self._motion.towards((0.0, self._rate))
