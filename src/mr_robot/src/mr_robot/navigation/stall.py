"""Notices wheels that turn while the robot stands: commanded motion against the pose that scans confirm."""

import math
from bisect import bisect_left, bisect_right
from typing import List, Tuple

from mr_grid import Pose
from mr_robot.navigation.options import LEAST_TURN, PROGRESS

SHORTEST_WINDOW = 0.4  # s looked back, and three and nine times that
WINDOWS = (SHORTEST_WINDOW, 3.0 * SHORTEST_WINDOW, 9.0 * SHORTEST_WINDOW)
MISSING = 0.7  # share of all commanded motion that a standing robot lacks: net motion of to and fro is mostly errors

Asked = Tuple[float, float, float, float]
"""By all commands until a time: signed way and turn, m and rad, and both with each way and turn counted forward."""


class StallWatch:
    def __init__(self, latency: float) -> None:
        """`latency`: s from a command to motion, a period of control."""
        self._latency = latency
        self.clear()

    def clear(self) -> None:
        self._command_times: List[float] = []
        # (m/s, rad/s) from then on, and what all before it asked for
        self._commands: List[Tuple[float, float, Asked]] = []
        self._pose_times: List[float] = []
        # And what had been asked for by then, when the latency is taken off
        self._poses: List[Tuple[Pose, Asked]] = []

    def command(self, now: float, velocity: Tuple[float, float]) -> None:
        """Records the command given at `now`."""
        asked = self._asked_until(now)
        self._command_times.append(now)
        self._commands.append((*velocity, asked))
        _forget(self._command_times, self._commands, now - self._latency)

    def blocked(self, now: float, pose: Pose) -> bool:
        """Whether the robot, now at `pose`, did not follow its commands. Once per step."""
        if self._pose_times and now < self._pose_times[-1]:
            self.clear()
        asked = self._asked_until(now - self._latency)
        self._pose_times.append(now)
        self._poses.append((pose, asked))
        _forget(self._pose_times, self._poses, now - WINDOWS[-1])
        return any(self._stands(now, pose, window, asked) for window in WINDOWS)

    def _stands(self, now: float, pose: Pose, window: float, asked: Asked) -> bool:
        index = bisect_left(self._pose_times, now - window - 1e-6)
        if now - self._pose_times[index] < window - 0.15:
            return False
        before, begun = self._poses[index]
        way, turn, all_ways, all_turns = (b - a for a, b in zip(begun, asked))
        if abs(turn) > math.pi:
            return False  # poses do not tell how often a robot turned
        turned = math.remainder(pose[2] - before[2], 2.0 * math.pi)
        stands = abs(way) - math.dist(pose[:2], before[:2]) > MISSING * all_ways
        still = abs(turn) - (turned if turn > 0.0 else -turned) > MISSING * all_turns
        if abs(way) >= PROGRESS:
            return stands and (still or abs(turn) < LEAST_TURN)
        return abs(turn) >= LEAST_TURN and still

    def _asked_until(self, time: float) -> Asked:
        if not self._commands:
            return 0.0, 0.0, 0.0, 0.0
        index = max(0, bisect_right(self._command_times, time) - 1)
        linear, angular, (way, turn, all_ways, all_turns) = self._commands[index]
        seconds = max(0.0, time - self._command_times[index])
        return (
            way + linear * seconds,
            turn + angular * seconds,
            all_ways + abs(linear) * seconds,
            all_turns + abs(angular) * seconds,
        )


def _forget(times: List[float], values: List, until: float) -> None:
    """All but the last of those before `until`, s."""
    old = max(0, bisect_left(times, until) - 1)
    del times[:old], values[:old]
