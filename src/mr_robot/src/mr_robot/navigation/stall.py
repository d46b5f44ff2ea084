"""Notices wheels that turn while the robot stands: commanded motion against the pose that scans confirm."""

import math
from bisect import bisect_left, bisect_right
from typing import List, Tuple

from mr_grid import Pose
from mr_robot.navigation.options import PROGRESS

WINDOWS = (0.4, 1.2, 3.6)  # s looked back, for robots of any speed
LEAST_TURN = 0.3  # rad commanded in such a time from which a standing robot is blocked, as from PROGRESS
STANDING = 0.3  # share of the commanded motion below which the robot stands


class StallWatch:
    def __init__(self, latency: float) -> None:
        """`latency`: s from a command to motion, a period of control."""
        self._latency = latency
        self._kept = 2 + math.ceil((WINDOWS[-1] + latency) / latency)  # commands and poses, one in each period
        self.clear()

    def clear(self) -> None:
        self._command_times: List[float] = []
        # (m/s, rad/s) from then on, and way and turn (m, rad) that all before it asked for
        self._commands: List[Tuple[float, float, float, float]] = []
        self._pose_times: List[float] = []
        self._poses: List[Pose] = []

    def command(self, now: float, velocity: Tuple[float, float]) -> None:
        """Records the command given at `now`."""
        way, turn = self._asked_until(now)
        self._command_times.append(now)
        self._commands.append((*velocity, way, turn))
        self._shorten(self._command_times, self._commands)

    def blocked(self, now: float, pose: Pose) -> bool:
        """Whether the robot, now at `pose`, did not follow its commands. Once per step."""
        if self._pose_times and now < self._pose_times[-1]:
            self.clear()
        self._pose_times.append(now)
        self._poses.append(pose)
        self._shorten(self._pose_times, self._poses)
        return any(self._stands(now, pose, window) for window in WINDOWS)

    def _stands(self, now: float, pose: Pose, window: float) -> bool:
        index = bisect_left(self._pose_times, now - window - 1e-6)
        since, before = self._pose_times[index], self._poses[index]
        if now - since < window - 0.15:
            return False
        distance, turn = self._commanded(since - self._latency, now - self._latency)
        moved = math.dist(pose[:2], before[:2])
        if abs(turn) > math.pi:
            return False  # poses do not tell how often a robot turned
        turned = math.remainder(pose[2] - before[2], 2.0 * math.pi)
        if abs(distance) >= PROGRESS and moved < STANDING * abs(distance):
            return abs(turn) < LEAST_TURN or abs(turned) < STANDING * abs(turn)
        return abs(turn) >= LEAST_TURN and turned / turn < STANDING and abs(distance) < PROGRESS

    def _commanded(self, start: float, end: float) -> Tuple[float, float]:
        """Signed way and turn, m and rad, that the commands between two times ask for."""
        way, turn = self._asked_until(end)
        way_before, turn_before = self._asked_until(start)
        return way - way_before, turn - turn_before

    def _asked_until(self, time: float) -> Tuple[float, float]:
        """Signed way and turn, m and rad, that all commands known ask for until then."""
        if not self._commands:
            return 0.0, 0.0
        index = max(0, bisect_right(self._command_times, time) - 1)
        linear, angular, way, turn = self._commands[index]
        seconds = max(0.0, time - self._command_times[index])
        return way + linear * seconds, turn + angular * seconds

    def _shorten(self, times: List[float], values: List) -> None:
        if len(times) >= 2 * self._kept:
            del times[: self._kept], values[: self._kept]
