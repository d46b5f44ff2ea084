"""When a registration between two robots is tried, believed, kept and given up.

A transform is believed at once only with strong evidence; otherwise it must be found again after the maps have grown.
It is then followed as the maps grow, and revoked when they come to contradict it.
"""

import math
from collections import OrderedDict
from dataclasses import dataclass, field
from typing import Callable, Hashable, NamedTuple, Optional, Tuple

import numpy as np

from . import features, registration
from .evidence import Evidence, compare
from .fusion import fused, resampled
from .grid import UNKNOWN, Grid
from .registration import (
    KEEP_CRITERIA,
    PRIOR_CRITERIA,
    STRONG_CRITERIA,
    Limits,
    Prior,
    Registration,
    Verdict,
    follow,
    judge,
    judge_kept,
)
from .search import same_place
from .sighting import SIGHTINGS_NEEDED, Sighting, moved, nowhere, places_seen
from .surface import Landmarks, landmarks_of, without_places
from .transform import Transform, rotation_between

SHORTEST_GROWTH_M = 3.0
SHORTEST_GROWTH = 1.15
"""The shared walls must have grown by so many metres, and by this factor, before a second look confirms a candidate."""
SURVEY_GROWTH = 1.4
"""Or both maps together by this factor, without a contradiction and without a rival having come up."""
_ROBOT_REACH_M = 0.35
"""A robot hides that much around its centre from the others' lasers."""
_SAME_DISTANCE = 0.4
_SAME_ROTATION = math.radians(1.5)
_STRIKES = 2
_CACHED_MAPS = 24
_CACHED_CELLS = 40_000_000
_LONGEST_WAIT_S = 20.0


class Versioned(NamedTuple):
    """A map and a key that changes whenever the map does."""

    key: Hashable
    grid: Grid


class Member(NamedTuple):
    """Another robot of the team whose transform to the own frame is believed."""

    map: Versioned
    transform: Transform


class LandmarkCache:
    """Landmarks of the most recently used maps, bounded in number and in cells. Used by one job at a time."""

    def __init__(self) -> None:
        self._known: OrderedDict[Hashable, Landmarks] = OrderedDict()

    def of(self, key: Hashable, grid: Callable[[], Grid]) -> Landmarks:
        """Landmarks of the map with this key, computed when needed."""
        if key not in self._known:
            self._known[key] = landmarks_of(grid())
        self._known.move_to_end(key)
        while len(self._known) > _CACHED_MAPS or (len(self._known) > 1 and self._cells() > _CACHED_CELLS):
            self._known.popitem(last=False)
        return self._known[key]

    def _cells(self) -> int:
        return sum(landmarks.clear.size for landmarks in self._known.values())


@dataclass(frozen=True, eq=False)
class Job:
    """One registration to compute: pure, may run in another thread. `run` does not change anything but the cache."""

    robot: str
    target: Versioned
    source: Versioned
    team: Tuple[Member, ...]
    current: Optional[Transform]
    prior: Optional[Prior]
    limits: Limits
    method: str
    cache: LandmarkCache
    target_track: np.ndarray = field(default_factory=nowhere)
    source_track: np.ndarray = field(default_factory=nowhere)
    """Where and when the robots of both maps have been, each (n, 3: x, y, time) in the frame of its own map."""
    other_tracks: np.ndarray = field(default_factory=nowhere)
    """The same of all other robots whose transform is known or proposed, in the target's frame."""
    others_placed: bool = True
    """False if another robot is on the move whose transform is neither known nor proposed."""
    seen: Tuple[Sighting, ...] = ()
    saw: Tuple[Sighting, ...] = ()
    """What the target's maps showed where the source's robot was, and the other way round."""

    def run(self) -> Registration:
        """The outcome; for a followed transform the verdict says whether it may be kept."""
        target = self.cache.of(self.target.key, lambda: self.target.grid)
        source = self.cache.of(self.source.key, lambda: self.source.grid)
        target = without_places(target, self.target_track[:, :2], _ROBOT_REACH_M)
        source = without_places(source, self.source_track[:, :2], _ROBOT_REACH_M)
        if self.current is not None:
            return self._follow(target, source, self.current)
        result = self._searched(target, source)
        if result.accepted and result.transform is not None:
            return result._replace(met=self._met(result.transform))
        return result

    def _searched(self, target: Landmarks, source: Landmarks) -> Registration:
        result = self._search(target, source)
        if not self.team:
            return result
        merged = self._merged()
        if not result.accepted and result.verdict is not Verdict.BEYOND_LIMITS:
            result = self._search(merged, source)
        if result.accepted and result.transform is not None:
            against = compare(merged, source, result.transform)
            if against.conflict > 1.5 * registration.DEFAULT_CRITERIA.conflict:
                return result._replace(verdict=Verdict.CONTRADICTS_TEAM)
        return result

    def _search(self, target: Landmarks, source: Landmarks) -> Registration:
        criteria = registration.DEFAULT_CRITERIA if self.prior is None else PRIOR_CRITERIA
        method = features.register if self.method == "features" else registration.register
        return method(target, source, criteria, self.limits, self.prior)

    def _met(self, transform: Transform) -> bool:
        back = transform.inverse()
        seen = places_seen(self.target.grid, self.seen, self.source_track, transform, self.other_tracks)
        saw = places_seen(self.source.grid, self.saw, self.target_track, back, moved(self.other_tracks, back))
        return seen + saw >= (1 if self.others_placed else SIGHTINGS_NEEDED)

    def _follow(self, target: Landmarks, source: Landmarks, current: Transform) -> Registration:
        better, evidence = follow(target, source, current)
        if evidence.matched < KEEP_CRITERIA.matched and self.team:
            target = self._merged()
            better, evidence = follow(target, source, current)
        if not same_place(better, current, source.surface.points, 0.5):
            # A jump is not a refinement; the transform stays, and the evidence for it decides.
            better, evidence = current, compare(target, source, current)
        return Registration(judge_kept(evidence), better, evidence)

    def _merged(self) -> Landmarks:
        key = (self.target.key, tuple((member.map.key, member.transform) for member in self.team))

        def merge() -> Grid:
            layers = [resampled(member.map.grid, member.transform, self.target.grid) for member in self.team]
            return fused(self.target.grid, [layer for layer in layers if layer is not None])

        return without_places(self.cache.of(key, merge), self.target_track[:, :2], _ROBOT_REACH_M)


def outcome_of(job: Job) -> Tuple[Registration, Optional[Exception]]:
    """Runs a job in the host's thread. A fault is an outcome too: the next job must find its thread alive."""
    try:
        return job.run(), None
    except Exception as fault:
        return Registration(Verdict.FAILED), fault


class Alignment:
    """What is known about the transform of one robot's frame to the own one."""

    def __init__(self) -> None:
        self.transform: Optional[Transform] = None
        self.evidence = Evidence()
        self.verdict = Verdict.NO_CANDIDATE
        self._candidate: Optional[Registration] = None
        self._strikes = 0
        self._tried: Optional[Tuple[Hashable, Hashable]] = None
        self._tried_cells: Tuple[int, ...] = (0, 0)
        self._due = -math.inf
        self._wait = 0.0
        self._last_started = -math.inf

    @property
    def proposed(self) -> Optional[Transform]:
        """The transform that is believed or, until one is, the one that waits for confirmation."""
        if self.transform is not None:
            return self.transform
        return None if self._candidate is None else self._candidate.transform

    def forget(self) -> None:
        """The robot's frame is a new one: nothing that was known holds."""
        self.__init__()  # type: ignore[misc]

    def due(self, now: float, target: Versioned, source: Versioned) -> bool:
        """True if a job is worth its time."""
        waits = now < self._due <= now + self._wait  # A later time is one from before the clock jumped back.
        if waits or (target.key, source.key) == self._tried:
            return False
        if self.transform is not None or self._candidate is not None:
            return True
        return any(
            present > 1.03 * before + 50 for present, before in zip(_known_cells(target, source), self._tried_cells)
        )

    def started(self, now: float, target: Versioned, source: Versioned, period: float) -> None:
        """A job is under way; `period` is the shortest time in seconds to the next one."""
        self._tried, self._tried_cells = (target.key, source.key), _known_cells(target, source)
        self._wait = (
            period
            if self.transform is not None or self._candidate is not None
            else min(max(period, 1.3 * self._wait), max(period, _LONGEST_WAIT_S))
        )
        self._due = now + self._wait
        self._last_started = now

    def started_before(self, now: float) -> float:
        """When the last job was started; minus infinity if none was, or the clock has jumped back since."""
        return self._last_started if self._last_started <= now else -math.inf

    def finished(self, result: Registration) -> str:
        """Takes the outcome of a job. Returns a text if something changed that a person wants to know, else ''."""
        self.verdict = result.verdict
        if self.transform is not None:
            return self._followed(result)
        return self._found(result)

    def _found(self, result: Registration) -> str:
        if not result.accepted or result.transform is None:
            if result.verdict in (Verdict.CONTRADICTED, Verdict.AMBIGUOUS, Verdict.CONTRADICTS_TEAM):
                self._candidate = None
            return ""
        if not (result.met or judge(result.evidence, STRONG_CRITERIA) is Verdict.ACCEPTED or self._confirms(result)):
            if not self._agrees(result):
                self._candidate = result
            return ""
        self.transform, self.evidence, self._candidate, self._strikes = result.transform, result.evidence, None, 0
        return "accepted"

    def _agrees(self, result: Registration) -> bool:
        before = self._candidate
        if before is None or before.transform is None or result.transform is None:
            return False
        between = before.transform.inverse().compose(result.transform)
        return (
            math.hypot(between.x, between.y) <= _SAME_DISTANCE
            and rotation_between(before.transform, result.transform) <= _SAME_ROTATION
        )

    def _confirms(self, result: Registration) -> bool:
        before = self._candidate
        if before is None or not self._agrees(result):
            return False
        if not result.prior:
            return False
        matched = before.evidence.matched
        if result.evidence.matched >= max(matched + SHORTEST_GROWTH_M, matched * SHORTEST_GROWTH):
            return True
        return result.surveyed >= SURVEY_GROWTH * before.surveyed and result.evidence.matched >= 0.95 * matched

    def _followed(self, result: Registration) -> str:
        self.evidence = result.evidence
        if result.verdict is Verdict.CONTRADICTED:
            self._strikes += 1
            if self._strikes >= _STRIKES:
                self.forget()
                self.verdict = result.verdict
                return "revoked"
            return ""
        self._strikes = 0
        if result.accepted and result.transform is not None:
            self.transform = result.transform
        return ""


def _known_cells(*maps: Versioned) -> Tuple[int, ...]:
    return tuple(int(np.count_nonzero(each.grid.cells != UNKNOWN)) for each in maps)
