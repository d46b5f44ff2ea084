"""Merging without fault or delay: who is on the radio knows what everyone else has seen."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Callable, Mapping

import numpy as np

from mr_experiments.common.stopwatch import Stopwatch
from mr_experiments.host.agenda import Agenda
from mr_experiments.host.merging import MergerListener
from mr_grid import OccupancyGrid, Pose
from mr_measures.true_map import TrueMap

POSITION_PERIOD = 1.0  # s between positions, as map_merger's seconds_send_position in mr_launch


@dataclass
class TeamSight:
    """What robots with perfect maps have seen, as polygons (n, 2), and where they are. World frame, m.

    Kept for those that join late; a look from another place takes 3 kB.
    """

    starts: Mapping[str, Pose]
    areas: dict[str, list[np.ndarray]] = field(default_factory=dict)
    poses: dict[str, Pose] = field(default_factory=dict)

    def add(self, robot: str, area: np.ndarray, pose: Pose) -> None:
        """`area`: what is visible from `pose`."""
        self.areas.setdefault(robot, []).append(area)
        self.poses[robot] = pose


class PerfectMerger:
    """Takes the place of `merging.Merger` where only the strategy is asked for."""

    def __init__(
        self, name: str, true_map: TrueMap, sight: TeamSight, agenda: Agenda, stopwatch: Stopwatch,
        listener: MergerListener, clock: Callable[[], float],
    ) -> None:  # fmt: skip
        self._name, self._map, self._sight = name, true_map, sight
        self._agenda, self._stopwatch, self._listener, self._clock = agenda, stopwatch, listener, clock
        self._seen = true_map.nothing()
        self._taken: dict[str, int] = {name: 0}  # areas of each robot that have been added
        self._present: set[str] = set()
        self._running = True

    def start(self, now: float) -> None:
        self._agenda.every(POSITION_PERIOD, now, self._tell_positions)

    def stop(self) -> None:
        """The robot is no more."""
        self._running = False

    def on_local_map(self, local: OccupancyGrid) -> None:
        """The robot's own map is part of what the team has seen; it only tells that it is time for a new one."""
        with self._stopwatch.span("merging"):
            for robot, taken in self._taken.items():
                areas = self._sight.areas.get(robot, [])
                for area in areas[taken:]:
                    self._map.add(area, self._seen)
                self._taken[robot] = len(areas)
            grid = self._map.known(self._seen)
        self._listener.on_global_map(grid, self._clock())

    def on_pose(self, x: float, y: float, yaw: float) -> None:
        """Others know it by their sight of the team."""

    def on_robot(self, name: str, returned: bool = False) -> None:
        self._present.add(name)
        self._taken.setdefault(name, 0)

    def on_robot_lost(self, name: str) -> None:
        """What it has seen stays known."""
        self._present.discard(name)

    def on_packet(self, topic: str, octets: bytes) -> bool:
        return False

    def transforms(self) -> dict[str, Pose]:
        """From the frame of each other robot to the own one."""
        return {robot: self._transform(robot) for robot in sorted(self._taken) if robot != self._name}

    def transform_point(self, robot: str, point: tuple[float, float]) -> tuple[float, float] | None:
        if robot not in self._taken:
            return None
        x, y = self._transform(robot).apply(np.array([point]))[0].tolist()
        return x, y

    def _transform(self, robot: str) -> Pose:
        starts = self._sight.starts
        return Pose(*starts[self._name].between(starts[robot]))

    def _tell_positions(self, now: float) -> None:
        if not self._running:
            return
        start = self._sight.starts[self._name].inverse()
        poses = {robot: self._sight.poses[robot] for robot in sorted(self._present) if robot in self._sight.poses}
        self._listener.on_positions({robot: start.compose(pose)[:2] for robot, pose in poses.items()}, now)
