"""Notices wheels that turn while the robot stands: commanded motion against the pose that scans confirm."""

import math
from collections import deque
from typing import Deque, Tuple

from mr_sim.pose import Pose

# (s looked back, m and rad commanded in that time from which a standing robot is blocked)
WINDOWS = ((0.4, 0.1, 0.35), (1.2, 0.08, 0.3))
LATENCY = 0.1  # s from a command to motion
STANDING = 0.3  # share of the commanded motion below which the robot stands


class StallWatch:
    def __init__(self) -> None:
        self._commands: Deque[Tuple[float, float, float]] = deque(maxlen=50)  # time, linear, angular
        self._poses: Deque[Tuple[float, Pose]] = deque(maxlen=50)

    def clear(self) -> None:
        self._commands.clear()
        self._poses.clear()

    def command(self, now: float, velocity: Tuple[float, float]) -> None:
        """Records the command given at `now`."""
        self._commands.append((now, velocity[0], velocity[1]))

    def blocked(self, now: float, pose: Pose) -> bool:
        """Whether the robot, now at `pose`, did not follow its commands. Once per step."""
        if self._poses and now < self._poses[-1][0]:
            self.clear()
        self._poses.append((now, pose))
        return any(self._stands(now, pose, *window) for window in WINDOWS)

    def _stands(self, now: float, pose: Pose, window: float, least_distance: float, least_turn: float) -> bool:
        start = next(((t, p) for t, p in self._poses if t >= now - window - 1e-6), None)
        if start is None or now - start[0] < window - 0.15:
            return False
        distance, turn = self._commanded(start[0] - LATENCY, now - LATENCY)
        moved = math.dist(pose[:2], start[1][:2])
        turned = math.remainder(pose[2] - start[1][2], 2.0 * math.pi)
        if abs(distance) >= least_distance and moved < STANDING * abs(distance):
            return abs(turn) < least_turn or abs(turned) < STANDING * abs(turn)
        return abs(turn) >= least_turn and turned / turn < STANDING and abs(distance) < least_distance

    def _commanded(self, start: float, end: float) -> Tuple[float, float]:
        """Signed way and turn, m and rad, that the commands between two times ask for."""
        distance = turn = 0.0
        for index, (time, linear, angular) in enumerate(self._commands):
            until = self._commands[index + 1][0] if index + 1 < len(self._commands) else end
            overlap = max(0.0, min(until, end) - max(time, start))
            distance += linear * overlap
            turn += angular * overlap
        return distance, turn
