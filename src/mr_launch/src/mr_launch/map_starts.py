"""Where in the world the new map of a robot begins whose SLAM was started again, if it is a new one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from mr_grid import Pose
from mr_grid.map_frame import run_named
from mr_launch.reports import RobotReport
from mr_launch.robot_log import RobotLog
from mr_launch.truth import Track

SETTLED = 1.0  # s of simulation time; what is believed later than that after SLAM has ended, is in the new map


@dataclass(frozen=True)
class Lost:
    at: float  # s of simulation time
    begun: list[int] | None  # as `RobotReport.map_begun`


def _goes_on(report: RobotReport, lost: Lost) -> bool:
    """Whether SLAM goes on with its map: it says when that was begun."""
    begun = report.map_begun
    if begun is None or begun != lost.begun:
        return False
    return run_named((begun[0], begun[1]), report.map_stamp) is not None


class MapStarts:
    """Knows it as soon as there is a map again and its robot says where it believes to be in it: the trace says where
    it was then."""

    def __init__(self) -> None:
        self._lost: dict[str, Lost] = {}

    def lose(self, report: RobotReport, now: float) -> None:
        """SLAM of the robot has ended; `report`: what was told of it last, `now`: s of simulation time."""
        self._lost[report.robot] = Lost(now, report.map_begun)

    def found(
        self, reports: Mapping[str, RobotReport], logs: Mapping[str, RobotLog], tracks: Mapping[str, Track]
    ) -> dict[str, Pose]:
        """Starts of new maps, true pose in the frame of the world, each once."""
        again = {robot: reports[robot] for robot, lost in self._lost.items() if reports[robot].map_stamp > lost.at}
        for robot, report in again.items():
            if _goes_on(report, self._lost[robot]):
                del self._lost[robot]
        starts = {robot: self._start(robot, logs, tracks) for robot in again if robot in self._lost}
        known = {robot: start for robot, start in starts.items() if start is not None}
        for robot in known:
            del self._lost[robot]
        return known

    def _start(self, robot: str, logs: Mapping[str, RobotLog], tracks: Mapping[str, Track]) -> Pose | None:
        since = self._lost[robot].at + SETTLED
        for at, believed in logs[robot].poses:
            true = tracks[robot].at(at) if at > since else None
            if true is not None:
                return true.compose(believed.inverse())
        return None
