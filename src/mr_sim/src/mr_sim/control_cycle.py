"""When navigation of a simulated robot is asked, and the scan that it sees then."""

import math

import numpy as np

from mr_grid import Pose
from mr_robot.navigation.options import Scan, make_scan
from mr_sim.world_description import RangerDescription

_JITTER = 1e-6  # s by which sums of periods are off


class ControlCycle:
    """As in the node: navigation has a period of its own, however often the laser scans, and sees the latest scan from
    where the robot is by then."""

    def __init__(self, ranger: RangerDescription, period: float) -> None:
        """`period`: s from one command to the next."""
        self._beams = ranger.angle_min, ranger.angle_increment, ranger.range_min, ranger.range_max
        self._mount, self._period = ranger.mount, period
        self._ranges = np.empty(0)
        self._taken: Pose | None = None
        self._next = math.inf

    def see(self, ranges: np.ndarray, odometry: Pose, now: float) -> None:
        """A scan, m, and the robot in its odometry frame at that moment. The first one begins the cycle."""
        if self._taken is None:
            self._next = now
        self._ranges, self._taken = ranges, odometry

    def due(self, now: float) -> bool:
        """Whether a command is due; once for each. What is late by more than a period is not made up for."""
        if now < self._next - _JITTER:
            return False
        self._next = (self._next if now < self._next + self._period else now) + self._period
        return True

    def scan(self, odometry: Pose) -> Scan:
        """The latest scan as seen from where the robot is in its odometry frame. Only after the first one."""
        assert self._taken is not None
        moved = odometry != self._taken
        mount = odometry.between(self._taken).compose(self._mount) if moved else self._mount
        return make_scan(self._ranges, *self._beams, mount)
