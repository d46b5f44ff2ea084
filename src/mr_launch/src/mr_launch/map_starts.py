"""Where in the world the new map of a robot begins whose SLAM was started again."""

from __future__ import annotations

from collections.abc import Mapping

from mr_grid import Pose
from mr_launch.robot_log import RobotLog
from mr_launch.truth import Track

SETTLED = 1.0  # s of simulation time; what is believed later than that after SLAM has ended, is in the new map


class MapStarts:
    """Knows it as soon as a robot says where it believes to be in its new map: the trace says where it was then."""

    def __init__(self) -> None:
        self._lost: dict[str, float] = {}

    def lose(self, robot: str, now: float) -> None:
        """SLAM of the robot has ended; `now`: s of simulation time."""
        self._lost[robot] = now

    def found(self, logs: Mapping[str, RobotLog], tracks: Mapping[str, Track]) -> dict[str, Pose]:
        """Starts of new maps, true pose in the frame of the world, each once."""
        starts = {robot: self._start(robot, logs, tracks) for robot in self._lost}
        known = {robot: start for robot, start in starts.items() if start is not None}
        for robot in known:
            del self._lost[robot]
        return known

    def _start(self, robot: str, logs: Mapping[str, RobotLog], tracks: Mapping[str, Track]) -> Pose | None:
        since = self._lost[robot] + SETTLED
        for at, believed in logs[robot].poses:
            true = tracks[robot].at(at) if at > since else None
            if true is not None:
                return true.compose(believed.inverse())
        return None
