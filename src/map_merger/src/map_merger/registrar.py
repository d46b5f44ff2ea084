"""Which pair is registered when, with what evidence, and what came of it."""

import math
from typing import Dict, Mapping, NamedTuple, Optional, Tuple

import numpy as np

from .alignment import Alignment
from .covariance import prior_from
from .effects import Register
from .job import Job, LandmarkCache, Member, Versioned
from .map_sightings import MapSightings
from .meetings import Hypothesis, Meetings
from .options import Options
from .registration import Limits, Registration
from .search import Prior
from .sighting import moved, nowhere
from .transform import Transform
from .graph.team import Placement
from .whereabouts import Whereabouts


SHORTEST_PAUSE_S = 0.5
"""Between two registrations of a pair while there is news from sightings."""


class Team(NamedTuple):
    """What is known for registrations now. maps: of the other robots. placed: those whose frame is placed in the own one.
    base: robot whose map is the own one."""

    target: Versioned
    maps: Mapping[str, Versioned]
    placed: Mapping[str, Placement]
    base: Optional[str]


class Registrar:
    """Owns the alignments with all other robots and the one registration under way."""

    def __init__(
        self, options: Options, whereabouts: Whereabouts, sightings: MapSightings, meetings: Meetings
    ) -> None:
        """Reads all but `options` anew for each registration."""
        self._options = options
        self._whereabouts, self._sightings, self._meetings = whereabouts, sightings, meetings
        self._alignments: Dict[str, Alignment] = {}
        self._generations: Dict[str, int] = {}
        self._cache = LandmarkCache()
        self._busy = False

    def alignment(self, robot: str) -> Alignment:
        """What is known about the transform of the robot's frame."""
        return self._alignments.setdefault(robot, Alignment())

    def believed(self) -> Dict[str, Alignment]:
        """The robots whose transform was found here and is believed."""
        return {name: each for name, each in sorted(self._alignments.items()) if each.belief is not None}

    def forget(self, robot: str) -> None:
        """The robot's frame or the own one is a new one: nothing that was found out between them holds."""
        self._alignments.pop(robot, None)
        self._generations[robot] = self._generations.get(robot, 0) + 1

    def next_job(self, now: float, team: Team) -> Optional[Register]:
        """The registration to start now; None if one is under way or none is due."""
        if self._busy:
            return None
        for robot in sorted(team.maps, key=lambda robot: self.alignment(robot).started_before(now)):
            if robot == team.base:
                continue
            alignment, source = self.alignment(robot), team.maps[robot]
            hypotheses = self._meetings.hypotheses(robot, now) if alignment.transform is None else ()
            news = sum(each.samples for each in hypotheses)
            period = self._period(alignment, bool(hypotheses))
            if period is not None and alignment.due(now, team.target, source, news):
                alignment.started(now, team.target, source, period, news)
                self._busy = True
                return Register(self._job(robot, team, hypotheses), self._generations.get(robot, 0))
        return None

    def finished(self, effect: Register, result: Registration) -> Optional[str]:
        """Takes the outcome of a job; `accepted`, `moved` or `revoked` if the transform came, jumped or went, '' if it
        did not, None if the outcome is of a former frame."""
        self._busy = False
        robot = effect.job.robot
        if effect.generation != self._generations.get(robot, 0):
            return None
        return self.alignment(robot).finished(result)

    def _period(self, alignment: Alignment, sighted: bool) -> Optional[float]:
        """Shortest time in seconds between two registrations; None if there are none."""
        if alignment.transform is None:
            return SHORTEST_PAUSE_S if sighted else float(self._options.seconds_pub_timer)
        period = self._options.seconds_recompute_transform
        return None if period < 0 else float(period)

    def _job(self, robot: str, team: Team, hypotheses: Tuple[Hypothesis, ...]) -> Job:
        members = tuple(
            Member(team.maps[name], team.placed[name].transform)
            for name in sorted(team.maps)
            if name != robot and name in team.placed
        )
        others, all_placed = self._others(robot, team)
        seen, saw = self._sightings.of(robot)
        return Job(
            robot,
            team.target,
            team.maps[robot],
            members,
            self.alignment(robot).transform,
            self._prior(robot, team),
            self._limits(team.target.grid.info.resolution),
            self._options.registration,
            self._cache,
            self._whereabouts.own_track.timed_points(),
            self._whereabouts.track(robot).timed_points(),
            others,
            all_placed,
            seen,
            saw,
            hypotheses,
        )

    def _others(self, robot: str, team: Team) -> Tuple[np.ndarray, bool]:
        """Where and when robots were that may be taken for `robot`, in the own frame, (n, 3); False if not of all.

        Who has neither map nor position, like a base station, does not drive about.
        """
        moving = {name for name in {*team.maps, *self._whereabouts.heard()} if name not in (robot, team.base)}
        tracks = [nowhere()]
        known = 0
        for name in sorted(moving):
            placed = team.placed.get(name)
            proposed = self.alignment(name).proposed if placed is None else placed.transform
            if proposed is not None and self._whereabouts.position(name) is not None:
                tracks.append(moved(self._whereabouts.track(name).timed_points(), proposed))
                known += 1
        return np.concatenate(tracks), known == len(moving)

    def _prior(self, robot: str, team: Team) -> Optional[Prior]:
        poses = self._options.initial_poses
        own = team.base or self._options.robot_name
        if own in poses and robot in poses:
            return Prior(poses[own].inverse().compose(poses[robot]))
        placed = team.placed.get(robot)
        return None if placed is None else prior_from(placed.transform, placed.covariance)

    def _limits(self, resolution: float) -> Limits:
        cells, degrees = self._options.max_trans_robots, self._options.max_rotation_robots
        return Limits(math.inf if cells < 0 else cells * resolution, math.inf if degrees < 0 else math.radians(degrees))
