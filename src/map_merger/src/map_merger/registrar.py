"""Which pair is registered when, with what evidence, and what came of it."""

import math
from dataclasses import replace
from typing import Collection, Dict, Mapping, NamedTuple, Optional, Tuple

import numpy as np

from .alignment import Alignment
from .covariance import prior_from
from .effects import Register
from .graph.team import Placement
from .job import Job, LandmarkCache, Member, Versioned
from .map_sightings import MapSightings
from .meetings import Meetings, Sightings
from .meetings.tracking import moves
from .options import Options
from .presence import SHORTEST_WAY_M
from .registration import Limits, Registration, Verdict
from .search import Prior
from .sighting import moved, nowhere
from .timer import Timer
from .whereabouts import Whereabouts

LOOK_PERIOD_S = 0.5
"""Between two looks at the sightings of a robot that is not placed."""


IN_SIGHT_S = 3.0
"""What moved that long ago may be a robot that is there."""


class Team(NamedTuple):
    """What is known for registrations now. maps: of the other robots. placed: those whose frame is placed in the own
    one. disputed: those to whom an own transform is part of a contradiction. base: robot whose map is the own one."""

    target: Versioned
    maps: Mapping[str, Versioned]
    placed: Mapping[str, Placement]
    disputed: Collection[str]
    base: Optional[str]


class Registrar:
    """Owns the alignments with all other robots and the one registration under way."""

    def __init__(self, options: Options, whereabouts: Whereabouts, sightings: MapSightings, meetings: Meetings) -> None:
        """Reads all but `options` anew for each registration."""
        self._options = options
        self._whereabouts, self._sightings, self._meetings = whereabouts, sightings, meetings
        self._alignments: Dict[str, Alignment] = {}
        self._generations: Dict[str, int] = {}
        self._cache = LandmarkCache(options.robot_size)
        self._look_timers: Dict[str, Timer] = {}
        self._words: Dict[str, str] = {}
        self._started: Dict[str, float] = {}
        self._busy = False

    def alignment(self, robot: str) -> Alignment:
        """What is known about the transform of the robot's frame."""
        if robot not in self._alignments:
            self._alignments[robot] = Alignment()
        return self._alignments[robot]

    def believed(self) -> Dict[str, Alignment]:
        """The robots whose transform was found here and is believed."""
        return {name: each for name, each in sorted(self._alignments.items()) if each.belief is not None}

    def forget(self, robot: str) -> None:
        """The robot's frame or the own one is a new one: nothing that was found out between them holds."""
        self._alignments.pop(robot, None)
        self._look_timers.pop(robot, None)
        self._words.pop(robot, None)
        self._generations[robot] = self._generations.get(robot, 0) + 1

    def generation(self, robot: str) -> int:
        """Another one after each `forget`."""
        return self._generations.get(robot, 0)

    def next_job(self, now: float, team: Team) -> Optional[Register]:
        """The registration to start now; None if one is under way or none is due."""
        if self._busy:
            return None
        for robot in sorted(team.maps, key=lambda robot: self._last_job(robot, now)):
            if robot == team.base:
                continue
            job = self._due_job(robot, now, team)
            if job is not None:
                self._busy, self._started[robot] = True, now
                return Register(job, self.generation(robot))
        return None

    def _due_job(self, robot: str, now: float, team: Team) -> Optional[Job]:
        alignment, source = self.alignment(robot), team.maps[robot]
        period = self._period(alignment)
        seen, saw = self._sightings.of(robot)
        news = len(seen) + len(saw) if alignment.awaits_meeting else 0
        look = alignment.transform is None and self._look_timer(robot).fires(now)
        meeting = self._meetings.sightings(robot, now) if look else None
        in_sight = meeting is not None and _something_moves(meeting, now)
        search = period is not None and alignment.due(now, team.target, source, news, robot in team.disputed, in_sight)
        if search and not look and alignment.transform is None:
            meeting = self._meetings.sightings(robot, now)
        if search and period is not None:
            alignment.started(now, team.target, source, period, news)
        elif meeting is None:
            return None
        return replace(self._job(robot, team), meeting=meeting, search=search)

    def _last_job(self, robot: str, now: float) -> float:
        """When the last one was started; minus infinity if none was, or the clock has jumped back since."""
        last = self._started.get(robot, -math.inf)
        return last if last <= now else -math.inf

    def _look_timer(self, robot: str) -> Timer:
        return self._look_timers.setdefault(robot, Timer(LOOK_PERIOD_S))

    def finished(self, effect: Register, result: Registration) -> Optional[str]:
        """Takes the outcome of a job; `accepted`, `moved` or `revoked` if the transform came, jumped or went, '' if it
        did not, None if the outcome is of a former frame."""
        self._busy = False
        robot = effect.job.robot
        if effect.generation != self._generations.get(robot, 0):
            return None
        if result.words:
            self._words[robot] = result.words
        if not (effect.job.search or result.accepted or result.verdict is Verdict.FAILED):
            return ""
        return self.alignment(robot).finished(result)

    def why(self, robot: str) -> str:
        """Why there is (no) transform to the robot, in words."""
        alignment = self.alignment(robot)
        words = self._words.get(robot) or self._meetings.why(robot)
        return alignment.reason if alignment.belief is not None or not words else f"{alignment.reason}; {words}"

    def _period(self, alignment: Alignment) -> Optional[float]:
        """Shortest time in seconds between two registrations; None if there are none."""
        if alignment.transform is None:
            return float(self._options.seconds_pub_timer)
        period = self._options.seconds_recompute_transform
        return None if period < 0 else float(period)

    def _job(self, robot: str, team: Team) -> Job:
        others, all_placed = self._others(robot, team)
        seen, saw = self._sightings.of(robot)
        return Job(
            robot,
            team.target,
            team.maps[robot],
            self._members(robot, team),
            self.alignment(robot).transform,
            self._prior(robot, team),
            self._limits(team.target.grid.info.resolution),
            self._options.registration,
            self._cache,
            self._options.robot_size,
            (self._whereabouts.own_track if team.base is None else self._whereabouts.track(team.base)).timed_points(),
            self._whereabouts.track(robot).timed_points(),
            others,
            all_placed,
            seen,
            saw,
            suggested=self.alignment(robot).suggested,
        )

    def _members(self, robot: str, team: Team) -> Tuple[Member, ...]:
        """The others whose walls may speak about the robot. Who is placed through it would confirm whatever transform
        it has; and if it is placed through others itself, a transform found by theirs would pass for one more witness.
        """
        if robot in team.placed and self.alignment(robot).transform is None:
            return ()
        return tuple(
            Member(team.maps[name], team.placed[name].transform)
            for name in sorted(team.maps)
            if name != robot and name in team.placed and robot not in team.placed[name].via
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


def _something_moves(meeting: Sightings, now: float) -> bool:
    """Both robots see something that moves."""
    return all(
        any(moves(each.samples[each.samples[:, 0] >= now - IN_SIGHT_S], SHORTEST_WAY_M) for each in objects)
        for objects in (meeting.objects, meeting.told_objects)
    )
