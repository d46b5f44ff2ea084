"""Merging without fault: maps are told and drawn when map_merger would, and fit exactly once they share enough."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Callable, Sequence

import numpy as np

from map_merger.exchange.holding import Holding
from map_merger.options import Options
from map_merger.presence import SHORTEST_WAY_M
from map_merger.registration import PRIOR_CRITERIA, SIGHTED_CRITERIA, STRONG_CRITERIA
from mr_experiments.common.stopwatch import Stopwatch
from mr_experiments.host.agenda import Agenda
from mr_experiments.host.fast.team_sight import TeamSight
from mr_experiments.host.merging import REGISTRATION_TIME, MergerListener
from mr_grid import OccupancyGrid, Pose
from mr_measures.true_map import RESOLUTION, TrueMap
from mr_robot.slam.engine import SlamOptions

CELLS_OF_SLAM = (RESOLUTION / SlamOptions.resolution) ** 2  # per cell here; of them changes are counted


@dataclass
class _Other:
    """What is known of another robot. `drawn`: how many of its areas; `seen`: the mask that shows them, that of the own
    map once they are placed in it; `first`: where it was first seen; `met`: it was seen to drive."""

    seen: np.ndarray
    drawn: int = 0
    first: Pose | None = None
    met: bool = False


class PerfectMerger:
    """Takes the place of `merging.Merger` where only the strategy is asked for."""

    def __init__(
        self, options: Options, true_map: TrueMap, sight: TeamSight, agenda: Agenda, stopwatch: Stopwatch,
        listener: MergerListener, clock: Callable[[], float],
    ) -> None:  # fmt: skip
        self._options, self._name, self._map, self._sight = options, options.robot_name, true_map, sight
        self._agenda, self._stopwatch, self._listener, self._clock = agenda, stopwatch, listener, clock
        self._seen = true_map.nothing()
        self._own_drawn = 0  # own areas that are in the map
        self._others: dict[str, _Other] = {}
        self._present: set[str] = set()
        self._holding = Holding()
        self._known = self._told = 0  # SLAM's cells of the own local map, and those that the others know
        self._published = False
        self._running = True

    def start(self, now: float) -> None:
        self._agenda.every(self._options.seconds_send_position, now, self._tell_positions)
        self._agenda.every(self._options.seconds_send_timer, now, self._tell_map)
        self._agenda.every(self._options.seconds_pub_timer, now + self._options.seconds_pub_timer, self._draw_others)

    def stop(self) -> None:
        """The robot is no more."""
        self._running = False

    def on_local_map(self, local: OccupancyGrid) -> None:
        """The robot's own map is part of what the team has seen; it only tells that it is time for a new one."""
        with self._stopwatch.span("merging"):
            self._known = round(np.count_nonzero(local.cells >= 0) * CELLS_OF_SLAM)
            areas = self._sight.areas.get(self._name, [])
            self._draw(areas[self._own_drawn :], self._seen)
            news, self._own_drawn = len(areas) > self._own_drawn, len(areas)
        if news or not self._published:
            self._publish()

    def on_pose(self, x: float, y: float, yaw: float) -> None:
        """Others know it by their sight of the team; whom the robot sees drive it may place at once."""
        if not self._published:
            return
        for robot in sorted(self._present - self._placed()):
            self._look_for(robot)
            if self._others[robot].met:
                self._register(robot)

    def on_robot(self, name: str, returned: bool = False) -> None:
        self._present.add(name)
        if name not in self._others:
            self._others[name] = _Other(self._map.nothing())

    def on_robot_lost(self, name: str) -> None:
        """What it has told stays known."""
        self._present.discard(name)

    def on_packet(self, topic: str, octets: bytes) -> bool:
        return False

    def transforms(self) -> dict[str, Pose]:
        """From the frame of each other robot to the own one, where they are known."""
        return {robot: self._transform(robot) for robot in sorted(self._placed())}

    def transform_point(self, robot: str, point: tuple[float, float]) -> tuple[float, float] | None:
        if robot not in self._placed():
            return None
        x, y = self._transform(robot).apply(np.array([point]))[0].tolist()
        return x, y

    def _placed(self) -> set[str]:
        """The others whose maps can be drawn into the own one."""
        return self._others.keys() & self._sight.linked(self._name)

    def _transform(self, robot: str) -> Pose:
        starts = self._sight.starts
        return Pose(*starts[self._name].between(starts[robot]))

    def _tell_map(self, now: float) -> None:
        if self._running and self._holding.worth(self._known - self._told, self._told, now):
            self._told = self._known
            self._sight.tell(self._name)

    def _draw_others(self, now: float) -> None:
        if not self._running or not self._published:
            return
        placed = self._placed()
        with self._stopwatch.span("merging"):
            news = [self._draw_other(robot) for robot in sorted(placed)]
        if any(news):
            self._publish()
        for robot in sorted(self._others.keys() - placed):
            self._register(robot)

    def _register(self, robot: str) -> None:
        """Finds the transform of a robot's map if that and the own one share enough."""
        with self._stopwatch.span("registration"):
            self._draw_other(robot)
            if self._shared_walls(robot) >= self._enough(robot):
                self._agenda.at(self._clock() + REGISTRATION_TIME, functools.partial(self._find, robot))

    def _find(self, robot: str, now: float) -> None:
        """The transform of a robot's map."""
        if self._running:
            self._sight.link(self._name, robot)

    def _draw_other(self, robot: str) -> bool:
        """Takes what another robot has told; whether the own map shows more by it."""
        other, placed = self._others[robot], robot in self._placed()
        areas = self._sight.told_areas(robot, other.drawn)
        other.drawn += len(areas)
        first = placed and other.seen is not self._seen
        if first:
            self._seen |= other.seen
            other.seen = self._seen
        self._draw(areas, other.seen)
        return placed and (first or bool(areas))

    def _draw(self, areas: Sequence[np.ndarray], seen: np.ndarray) -> None:
        for area in areas:
            self._map.add(area, seen)

    def _shared_walls(self, robot: str) -> float:
        """m of wall that the own map and that of a robot show."""
        return self._map.wall_length(self._seen & self._others[robot].seen)

    def _enough(self, robot: str) -> float:
        """m of shared wall from which map_merger finds the transform."""
        if {self._name, robot} <= self._options.initial_poses.keys():
            return PRIOR_CRITERIA.matched
        return SIGHTED_CRITERIA.matched if self._others[robot].met else STRONG_CRITERIA.matched

    def _look_for(self, robot: str) -> None:
        """Notes whether a robot in sight has driven."""
        other = self._others[robot]
        if other.met or not self._sight.sees(self._name, robot):
            return
        pose = self._sight.poses[robot]
        other.first = other.first or pose
        other.met = math.dist(pose[:2], other.first[:2]) >= SHORTEST_WAY_M

    def _publish(self) -> None:
        self._published = True
        with self._stopwatch.span("merging"):
            grid = self._map.known(self._seen)
        self._listener.on_global_map(grid, self._clock())

    def _tell_positions(self, now: float) -> None:
        if not self._running:
            return
        start = self._sight.starts[self._name].inverse()
        poses = {robot: self._sight.poses[robot] for robot in sorted(self._present & self._placed())}
        self._listener.on_positions({robot: start.compose(pose)[:2] for robot, pose in poses.items()}, now)
