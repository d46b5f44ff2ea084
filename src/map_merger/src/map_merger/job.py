"""One registration to compute: pure, may run in another thread."""

from collections import OrderedDict
from dataclasses import dataclass, field
from typing import Callable, Hashable, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from mr_grid import OccupancyGrid, Pose

from . import registration
from .covariance import covariance_at_origin, covariance_of
from .evidence import compare
from .global_map import merged
from .meetings import Sightings, confirmed, hypotheses_of
from .methods import method_of
from .presence import is_refuted, presence_of
from .registration import (
    DEFAULT_CRITERIA,
    KEEP_CRITERIA,
    PRIOR_CRITERIA,
    REFUTING_WALL,
    SIGHTED_CRITERIA,
    Limits,
    Prior,
    Registration,
    Verdict,
    follow,
    judge,
    judge_kept,
)
from .robot_size import RobotSize
from .search import same_place
from .sighting import SIGHTINGS_NEEDED, Sighting, moved, nowhere, places_seen
from .surface import Landmarks, landmarks_of, without_places

LONGEST_STEP_M = 0.5
"""What moves the walls further is no refinement but a jump, as after a loop closure, and is searched for."""
BETTER_THAN_STAYING = 1.5
"""Factor of the scores from which on a jump is made."""
SAME_M = 0.25
"""Transforms that lay the walls of the source so near one another are the same one."""
_CACHED_MAPS = 24
_CACHED_CELLS = 40_000_000


class Versioned(NamedTuple):
    """A map and a key that changes whenever the map does."""

    key: Hashable
    grid: OccupancyGrid


class Member(NamedTuple):
    """Another robot of the team whose transform to the own frame is believed."""

    map: Versioned
    transform: Pose


class LandmarkCache:
    """Landmarks of the most recently used maps, bounded in number and in cells. Used by one job at a time."""

    def __init__(self, size: RobotSize) -> None:
        """`size`: of the robots of the team."""
        self._mover = size.mover
        self._known: OrderedDict[Hashable, Landmarks] = OrderedDict()

    def of(self, key: Hashable, grid: Callable[[], OccupancyGrid]) -> Landmarks:
        """Landmarks of the map with this key, computed when needed."""
        if key not in self._known:
            self._known[key] = landmarks_of(grid(), self._mover)
        self._known.move_to_end(key)
        while len(self._known) > _CACHED_MAPS or (len(self._known) > 1 and self._cells() > _CACHED_CELLS):
            self._known.popitem(last=False)
        return self._known[key]

    def _cells(self) -> int:
        return sum(landmarks.clear.size for landmarks in self._known.values())


@dataclass(frozen=True, eq=False)
class Job:
    """A search for the transform from the source's frame to the target's, or a look whether `current` still holds.

    `run` does not change anything but the cache.
    """

    robot: str
    target: Versioned
    source: Versioned
    team: Tuple[Member, ...]
    current: Optional[Pose]
    prior: Optional[Prior]
    limits: Limits
    method: str
    cache: LandmarkCache
    size: RobotSize
    """Of the robots of the team."""
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
    meeting: Optional[Sightings] = None
    """What the robots' lasers show of one another. It is looked at first."""
    search: bool = True
    """False: nothing but the meeting is looked at."""
    suggested: Optional[Pose] = None
    """What the last search found, if the walls have nothing against it."""

    def run(self) -> Registration:
        """The outcome; for a followed transform the verdict says whether it may be kept."""
        target = self.cache.of(self.target.key, lambda: self.target.grid)
        source = self.cache.of(self.source.key, lambda: self.source.grid)
        target = without_places(target, self.target_track[:, :2], self.size.touching)
        source = without_places(source, self.source_track[:, :2], self.size.touching)
        if self.current is not None:
            return self._follow(target, source, self.current)
        if self.meeting is not None:
            result = self._confirmed(target, source, self.meeting)
            if not result.accepted:
                result = self._sighted(target, source, self.meeting, (self.suggested, result.transform)) or result
            if result.accepted or not self.search:
                return result
        result = self._searched(target, source)
        if result.accepted and result.transform is not None:
            result = result._replace(met=self._met(target, result.transform))
        if self.meeting is not None and not result.met:
            return self._sighted(target, source, self.meeting, (result.transform,)) or self._unless_not_there(result)
        return result

    def _unless_not_there(self, result: Registration) -> Registration:
        """Walls have copies; in the wrong one the other robot is not seen."""
        refuted = (
            self.meeting is not None
            and result.accepted
            and result.transform is not None
            and is_refuted(self.meeting, result.transform)
        )
        return result._replace(verdict=Verdict.NOT_THERE) if refuted else result

    def _confirmed(self, target: Landmarks, source: Landmarks, meeting: Sightings) -> Registration:
        """What the sightings say if the walls of both maps, and those of the team, have nothing against it."""
        found = confirmed(target, source, hypotheses_of(meeting), self.limits)
        result = found.registration._replace(words=found.words)
        if not result.accepted or result.transform is None:
            return result
        return self._unless_team_contradicts(source, result)._replace(
            covariance=covariance_at_origin(result.transform, found.covariance, found.centre)
        )

    def _sighted(
        self, target: Landmarks, source: Landmarks, meeting: Sightings, transforms: Sequence[Optional[Pose]]
    ) -> Optional[Registration]:
        """The first of the transforms by which the other robot was seen to drive, if the walls give that one and no
        other."""
        for transform in transforms:
            if (
                self.prior is not None
                or transform is None
                or not presence_of(meeting, target, transform, self.size).confirms
            ):
                continue
            better, evidence = follow(target, source, transform)
            if judge(evidence, SIGHTED_CRITERIA) is not Verdict.ACCEPTED:
                continue
            found = registration.register(target, source, SIGHTED_CRITERIA, self.limits)
            if found.accepted and found.transform is not None and _are_same(found.transform, better, source):
                result = self._unless_team_contradicts(source, found._replace(met=True))
                return _with_covariance(target, source, result) if result.accepted else None
        return None

    def _searched(self, target: Landmarks, source: Landmarks) -> Registration:
        result = self._search(target, source)
        if not self.team:
            return result
        if not result.accepted and result.verdict is not Verdict.BEYOND_LIMITS:
            result = self._search(self._merged(), source)
        return self._unless_team_contradicts(source, result)

    def _unless_team_contradicts(self, source: Landmarks, result: Registration) -> Registration:
        if self.team and result.accepted and result.transform is not None:
            against = compare(self._merged(), source, result.transform)
            if against.against >= REFUTING_WALL and against.conflict > 1.5 * DEFAULT_CRITERIA.conflict:
                return result._replace(verdict=Verdict.CONTRADICTS_TEAM)
        return result

    def _search(self, target: Landmarks, source: Landmarks) -> Registration:
        criteria = DEFAULT_CRITERIA if self.prior is None else PRIOR_CRITERIA
        if 0.0 < min(target.surface.length, source.surface.length) < criteria.matched:
            # As every transform would be; most searches at the start are of such maps.
            return Registration(Verdict.TOO_LITTLE_SHARED_WALL)
        result = method_of(self.method)(target, source, criteria, self.limits, self.prior)
        if result.rivals:
            result = self._chosen_by_meeting(target, source, result)
        return _with_covariance(target, source, result)

    def _chosen_by_meeting(self, target: Landmarks, source: Landmarks, result: Registration) -> Registration:
        """Walls alone cannot choose between rivals; that the robots met by exactly one of them can."""
        rivals = [each for each in (result.transform, *result.rivals) if each is not None and self._met(target, each)]
        if not rivals or not all(_are_same(rivals[0], each, source) for each in rivals[1:]):
            return result
        transform, evidence = follow(target, source, rivals[0])
        verdict = judge(evidence, DEFAULT_CRITERIA if self.prior is None else PRIOR_CRITERIA)
        if verdict is Verdict.ACCEPTED and not self.limits.allow(transform):
            verdict = Verdict.BEYOND_LIMITS
        return result._replace(verdict=verdict, transform=transform, evidence=evidence, rivals=())

    def _met(self, target: Landmarks, transform: Pose) -> bool:
        """True if the robots saw one another where the transform says. Scans tell that better than what maps keep of
        robots: in a building of copies some of it lies where another transform says, too."""
        if self.meeting is not None and len(self.meeting.sweeps.times):
            return presence_of(self.meeting, target, transform, self.size).confirms
        back = transform.inverse()
        seen = places_seen(self.target.grid, self.seen, self.source_track, transform, self.other_tracks, self.size)
        saw = places_seen(
            self.source.grid, self.saw, self.target_track, back, moved(self.other_tracks, back), self.size
        )
        return seen + saw >= (1 if self.others_placed else SIGHTINGS_NEEDED)

    def _follow(self, target: Landmarks, source: Landmarks, current: Pose) -> Registration:
        better, evidence = follow(target, source, current)
        if evidence.matched < KEEP_CRITERIA.matched and self.team:
            target = self._merged()
            better, evidence = follow(target, source, current)
        jumps = not same_place(better, current, source.surface.points, LONGEST_STEP_M)
        if jumps:
            better, evidence = current, compare(target, source, current)
        verdict = judge_kept(evidence)
        if jumps or verdict is Verdict.CONTRADICTED:
            found = self._searched_nearby(target, source, current)
            if found.accepted and found.evidence.score > BETTER_THAN_STAYING * evidence.score:
                return _with_covariance(target, source, found)
        return _with_covariance(target, source, Registration(verdict, better, evidence))

    def _searched_nearby(self, target: Landmarks, source: Landmarks, current: Pose) -> Registration:
        """Either robot's SLAM may have closed a loop, which moves its map by little: not a matter of any transform."""
        return registration.register(target, source, PRIOR_CRITERIA, self.limits, Prior(current))

    def _merged(self) -> Landmarks:
        key = (self.target.key, tuple((member.map.key, member.transform) for member in self.team))

        def merge() -> OccupancyGrid:
            return merged(self.target.grid, [(member.map.grid, member.transform) for member in self.team])

        return without_places(self.cache.of(key, merge), self.target_track[:, :2], self.size.touching)


def _are_same(first: Pose, second: Pose, source: Landmarks) -> bool:
    return same_place(first, second, source.surface.points, SAME_M)


def _with_covariance(target: Landmarks, source: Landmarks, result: Registration) -> Registration:
    if not result.accepted or result.transform is None:
        return result
    return result._replace(covariance=covariance_of(target, source, result.transform))


def outcome_of(job: Job) -> Tuple[Registration, Optional[Exception]]:
    """Runs a job in the host's thread. A fault is an outcome too: the next job must find its thread alive."""
    try:
        return job.run(), None
    except Exception as fault:
        return Registration(Verdict.FAILED), fault
