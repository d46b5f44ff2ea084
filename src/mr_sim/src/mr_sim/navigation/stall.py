"""Notices wheels that turn while the robot stands: commanded motion against the pose that scans confirm."""

import math
from bisect import bisect_left, bisect_right
from typing import List, Tuple

from mr_sim.pose import Pose

# (s looked back, m and rad commanded in that time from which a standing robot is blocked)
WINDOWS = ((0.4, 0.1, 0.35), (1.2, 0.08, 0.3))
LATENCY = 0.1  # s from a command to motion
STANDING = 0.3  # share of the commanded motion below which the robot stands
KEPT = 50  # commands and poses; more than the longest window holds


class StallWatch:
    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        self._command_times: List[float] = []
        self._commands: List[Tuple[float, float]] = []  # m/s, rad/s
        self._pose_times: List[float] = []
        self._poses: List[Pose] = []

    def command(self, now: float, velocity: Tuple[float, float]) -> None:
        """Records the command given at `now`."""
        self._command_times.append(now)
        self._commands.append(velocity)
        _shorten(self._command_times, self._commands)

    def blocked(self, now: float, pose: Pose) -> bool:
        """Whether the robot, now at `pose`, did not follow its commands. Once per step."""
        if self._pose_times and now < self._pose_times[-1]:
            self.clear()
        self._pose_times.append(now)
        self._poses.append(pose)
        _shorten(self._pose_times, self._poses)
        return any(self._stands(now, pose, *window) for window in WINDOWS)

    def _stands(self, now: float, pose: Pose, window: float, least_distance: float, least_turn: float) -> bool:
        index = bisect_left(self._pose_times, now - window - 1e-6)
        since, before = self._pose_times[index], self._poses[index]
        if now - since < window - 0.15:
            return False
        distance, turn = self._commanded(since - LATENCY, now - LATENCY)
        moved = math.dist(pose[:2], before[:2])
        turned = math.remainder(pose[2] - before[2], 2.0 * math.pi)
        if abs(distance) >= least_distance and moved < STANDING * abs(distance):
            return abs(turn) < least_turn or abs(turned) < STANDING * abs(turn)
        return abs(turn) >= least_turn and turned / turn < STANDING and abs(distance) < least_distance

    def _commanded(self, start: float, end: float) -> Tuple[float, float]:
        """Signed way and turn, m and rad, that the commands between two times ask for."""
        times, distance, turn = self._command_times, 0.0, 0.0
        first, behind = max(0, bisect_right(times, start) - 1), bisect_left(times, end)
        for index in range(first, behind):
            until = min(times[index + 1], end) if index + 1 < len(times) else end
            seconds = until - max(times[index], start)
            distance += self._commands[index][0] * seconds
            turn += self._commands[index][1] * seconds
        return distance, turn


def _shorten(times: List[float], values: List) -> None:
    if len(times) >= 2 * KEPT:
        del times[:KEPT], values[:KEPT]
