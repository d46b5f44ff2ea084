"""Finds other robots among what the own robot sees, from what they tell of themselves."""

import math
from collections import OrderedDict
from typing import Collection, Dict, FrozenSet, Mapping, NamedTuple, Optional, Tuple

import numpy as np

from mr_grid import OccupancyGrid, Pose

from ..messages import NO_BOOT, Boot
from ..robot_size import RobotSize
from ..timer import LONGEST_AGE_S
from .detection import FARTHEST_M, objects_in_scan
from .doubts import doubts_of
from .heard import Heard
from .hypotheses import hypotheses_of
from .jumps import jumps_of
from .map_objects import objects_in_map
from .sightings import Sightings
from .sweeps import NO_SWEEPS, SweepHistory, Sweeps
from .telling import SLOW_S, Telling
from .tracking import Fragment, ObjectTracks, Trail
from .values import NO_SENSOR, Hypothesis, LaserScan, Sensor, TrackReport

SCAN_PERIOD_S = 0.2
MAP_PERIOD_S = 1.0
_POSE_PERIOD_S = 0.1
_MOST_ROBOTS = 64
_SILENT_S = 30.0
_CURRENT_S = 3.2 * SLOW_S
"""Who has somebody to place tells so every SLOW_S. Who has not, falls silent, and nobody waits for a last word."""


class _View(NamedTuple):
    """Where a robot was, (n, >= 3: time, x, y), and what it saw, in its own frame."""

    track: np.ndarray
    objects: Tuple[Fragment, ...]
    sweeps: Sweeps


class Meetings:
    """All that is known of the tracks of the own and the other robots. One owner, no thread: the `Sightings` that it
    hands out are values.

    name, boot: of the own robot's run. size: of the robots of the team.
    """

    def __init__(self, name: str, size: RobotSize, boot: Boot = NO_BOOT) -> None:
        self._name, self._boot, self._size = name, boot, size
        self._own = Trail(4, _POSE_PERIOD_S)
        self._objects = ObjectTracks()
        self._sweeps = SweepHistory()
        self._sensor: Sensor = NO_SENSOR
        self._heard: OrderedDict[str, Heard] = OrderedDict()
        self._unplaced: FrozenSet[str] = frozenset()
        self._stand_in: Optional[str] = None
        self._placed: Mapping[str, Pose] = {}
        self._telling = Telling()
        self._looked_at = -math.inf
        self._now = -math.inf
        self._latest: Dict[str, Tuple[Hypothesis, ...]] = {}

    def on_team(self, hearing: Collection[str], placed: Mapping[str, Pose], stand_in: Optional[str] = None) -> None:
        """Who is heard on the radio, and the transforms to the own frame that are believed. stand_in: the robot whose
        frame is the own one, on a base station; what that one tells stands for what the own robot sees."""
        self._placed, self._stand_in = dict(placed), stand_in
        self._unplaced = frozenset(hearing) - frozenset(placed) - {self._name}

    @property
    def watching(self) -> bool:
        """False when everybody in hearing is placed, by this robot and by those that tell their tracks: scans need not
        be handed in and nothing is told."""
        return bool(self._unplaced) or any(
            each.unplaced and self._now - each.heard_at <= _CURRENT_S for each in self._heard.values()
        )

    def on_own_pose(self, pose: Pose, now: float) -> None:
        """The own robot in its map frame."""
        self._now = now
        behind = self._own.rows[-1, 0] - now if len(self._own.rows) else 0.0
        if behind > LONGEST_AGE_S + _POSE_PERIOD_S:
            self._restart_clock()
        if 0.0 < behind <= LONGEST_AGE_S + _POSE_PERIOD_S:
            self._own.merge(np.array([(now, *pose)]))
        else:
            self._own.add((now, *pose))

    def on_scan(self, scan: LaserScan, pose: Pose, now: float) -> None:
        """A sweep and the own pose in the map frame at its time, which may lie behind that of other calls."""
        self.on_own_pose(pose, now)
        self._sensor = scan.sensor
        if not self._due_to_look(now, SCAN_PERIOD_S):
            return
        centres = objects_in_scan(scan, self._size).centres
        self._sweeps.add(now, scan, pose)
        self._follow(centres, pose, now)

    def on_map(self, grid: OccupancyGrid, now: float) -> None:
        """In place of scans: the own map, whenever there is a new one; not looked at while nobody watches."""
        if not self.watching or not len(self._own.rows) or not self._due_to_look(now, MAP_PERIOD_S):
            return
        pose = Pose(*self._own.rows[-1, 1:4].tolist())
        self._follow(pose.inverse().apply(objects_in_map(grid, pose, FARTHEST_M, self._size.widest)), pose, now)

    def on_report(self, report: TrackReport, now: float) -> None:
        """What another robot tells. A new run forgets the former one."""
        self._now = now
        if report.robot == self._name:
            return
        if report.robot not in self._heard and len(self._heard) >= _MOST_ROBOTS:
            self._heard.popitem(last=False)
        heard = self._heard.setdefault(report.robot, Heard())
        if heard.take(report, now):
            self._latest.pop(report.robot, None)
        self._heard.move_to_end(report.robot)

    def forget(self, robot: str) -> None:
        """The robot is gone, or its frame is a new one."""
        self._heard.pop(robot, None)
        self._latest.pop(robot, None)

    def forget_own(self) -> None:
        """The own frame is a new one."""
        self._own.clear()
        self._objects.clear()
        self._sweeps.clear()
        self._latest.clear()

    def report(self, now: float) -> Optional[TrackReport]:
        """What to tell the others now, if it is time."""
        self._now = now
        if not self.watching or not len(self._own.rows) or not self._telling.due(now, self._lively(now)):
            return None
        poses, objects = self._telling.taken(now, self._own.rows, self._objects.present())
        return TrackReport(
            self._name,
            self._size.body_radius,
            self._boot,
            now,
            self._sensor,
            poses,
            objects,
            tuple(sorted(self._unplaced))[:_MOST_ROBOTS],
        )

    def sightings(self, robot: str, now: float) -> Optional[Sightings]:
        """All that speaks about the robot, for `hypotheses_of` here or in another thread; None if it told nothing."""
        heard = self._heard.get(robot)
        if heard is None or now - heard.heard_at > _SILENT_S:
            return None
        own = self._view(now)
        if own is None:
            return None
        others = {name: each.track() for name, each in self._heard.items() if name not in (robot, self._stand_in)}
        told = heard.track()
        here, there = jumps_of(own.track), jumps_of(told)
        return Sightings(
            robot,
            here.steady(own.track),
            there.steady(told),
            here.steady_fragments(own.objects),
            there.steady_fragments(heard.fragments()),
            here.steady_sweeps(own.sweeps),
            heard.sensor,
            {name: jumps_of(track).steady(track) for name, track in others.items()},
            {name: transform for name, transform in self._placed.items() if name in others},
            math.hypot(here.size, there.size),
            here.mean_frame(own.track),
            there.mean_frame(told),
        )

    def hypotheses(self, robot: str, now: float) -> Tuple[Hypothesis, ...]:
        """The transforms of the robot's frame to the own one that are not refuted, best supported first."""
        sightings = self.sightings(robot, now)
        found = () if sightings is None else hypotheses_of(sightings)
        self._latest[robot] = found
        return found

    def why(self, robot: str) -> str:
        """In words, why the robot is not placed by sightings; '' if nothing speaks against the best hypothesis."""
        if robot not in self._heard:
            return f"{robot} does not tell its track"
        return doubts_of(self._latest.get(robot, ()))

    def _view(self, now: float) -> Optional[_View]:
        """What there is on the own side; None if the robot that stands for it tells nothing."""
        if self._stand_in is None:
            return _View(self._own.rows, self._objects.fragments(now), self._sweeps.all())
        heard = self._heard.get(self._stand_in)
        if heard is None or now - heard.heard_at > _SILENT_S:
            return None
        # Nobody tells its sweeps, so what a robot would have seen and did not speaks against nothing here.
        return _View(heard.track(), heard.fragments(), NO_SWEEPS)

    def _due_to_look(self, now: float, period: float) -> bool:
        if 0.0 <= now - self._looked_at < period - 0.01:
            return False
        self._looked_at = now
        return True

    def _follow(self, centres: np.ndarray, pose: Pose, now: float) -> None:
        order = np.argsort(np.hypot(centres[:, 0], centres[:, 1]), kind="stable")
        self._objects.take(now, pose.apply(centres[order]))

    def _lively(self, now: float) -> bool:
        """Something of a robot's size moves, here or by what others told."""
        return self._telling.lively(now, self._own.rows, self._objects.present()) or any(
            each.lively(now) for each in self._heard.values()
        )

    def _restart_clock(self) -> None:
        """Times from before the clock jumped back cannot be compared with those to come."""
        self.forget_own()
        self._heard.clear()
        self._looked_at = -math.inf
        self._telling = Telling()
