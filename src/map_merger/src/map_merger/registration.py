"""Registration of two occupancy grids with unknown transform: search, refine, verify, decide.

The decision prefers no answer to a wrong one. README.md says what is refused and why.
"""

import math
from dataclasses import dataclass
from enum import Enum
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from mr_grid import Pose

from .covariance import Covariance
from .evidence import Evidence, compare, compare_samples
from .refine import COARSE_REACH, FINE_REACH, refined
from .search import Prior, candidates
from .surface import Landmarks, subsample
from .transform import displacement, rotation_between


@dataclass(frozen=True)
class Criteria:
    """What a transform must show before it is believed. Lengths in metres of wall."""

    matched: float = 14.0
    minor: float = 4.0
    conflict: float = 0.06
    explained: float = 0.5
    rival: float = 0.75
    """Largest allowed score of a different transform, relative to the best."""
    plausible: float = 0.3
    """A different transform without contradictions is a rival from this share of the best one's matched wall on..."""
    plausible_wall: float = 6.0
    """...and from this length on."""
    doubtful: float = math.inf
    """So is, from this share on, one with few contradictions: where a longer one is wrong, so may be the shorter."""


DEFAULT_CRITERIA = Criteria()
PRIOR_CRITERIA = Criteria(matched=6.0, minor=1.5, plausible=0.6)
"""With a prior most rivals are excluded beforehand."""
Rule = Sequence[Criteria]
"""Enough for any of them is enough."""
STRONG_CRITERIA = Criteria(matched=40.0, minor=10.0, conflict=0.03)
"""Enough to be believed without a prior or a meeting: more than the walls of two rooms, which may have copies."""
SIGHTED_CRITERIA = Criteria(matched=7.0, minor=1.0, conflict=0.03, explained=0.35, plausible=0.4, plausible_wall=4.0)
"""Enough where something was seen to drive as the other robot did by the transform that the walls give."""
LARGEST_LOOKALIKE = 0.4
"""Buildings with more of it may have an exact copy of what both maps show."""
KEEP_CRITERIA = Criteria(matched=4.0, minor=1.0, conflict=0.2, explained=0.3)
"""What an accepted transform must go on showing."""
REFUTING_WALL = 1.0
"""So many metres in free space of the other map refute a transform even where hardly any wall is shared: the share of
KEEP_CRITERIA, at the length of KEEP_CRITERIA."""
PLAUSIBLE_CONFLICT, FEW_CONFLICTS = 0.08, 0.2
"""A transform with no more contradictions than the first could be true, with no more than the second fits by chance."""
_RANKED_POINTS = 20_000
"""Of larger surfaces (1 km of wall) so many points tell which transforms are worth a closer look."""


class Limits(NamedTuple):
    """Largest accepted translation per axis (m) and rotation (rad); infinite if unlimited."""

    translation: float = math.inf
    rotation: float = math.inf

    def allow(self, transform: Pose) -> bool:
        """True if the transform is inside the limits."""
        return max(abs(transform.x), abs(transform.y)) <= self.translation and abs(transform.yaw) <= self.rotation


UNLIMITED = Limits()


class Verdict(Enum):
    """Why a registration gave a transform or none."""

    ACCEPTED = "accepted"
    NO_CANDIDATE = "no candidate"
    TOO_LITTLE_SHARED_WALL = "too little shared wall"
    ONE_DIRECTION_ONLY = "shared walls in one direction only"
    CONTRADICTED = "walls of one map in free space of the other"
    UNEXPLAINED = "too many walls without a partner"
    AMBIGUOUS = "another transform fits nearly as well"
    CONTRADICTS_TEAM = "walls in free space of the merged map of the others"
    BEYOND_LIMITS = "beyond max_trans_robots or max_rotation_robots"
    NOT_THERE = "the other robot was not where this puts it"
    UNSETTLED = "sightings that leave doubts who was seen"
    INEXACT = "sightings and walls do not fix it exactly enough yet"
    FAILED = "registration failed"


class Rival(NamedTuple):
    """A different transform, what speaks for it, and how far (m, median) it lays the source's walls from the best."""

    transform: Pose
    evidence: Evidence
    apart: float


class Registration(NamedTuple):
    """Outcome: `transform` maps the source's frame to the target's and is to be used only if the verdict is
    ACCEPTED."""

    verdict: Verdict
    transform: Optional[Pose] = None
    evidence: Evidence = Evidence()
    surveyed: float = 0.0
    """Metres of wall in both maps together, shared or not."""
    prior: bool = False
    """True if a rough transform was given beforehand."""
    met: bool = False
    """True if one of the robots was seen by the other where the transform says it was (sighting)."""
    rival: Optional[Rival] = None
    """The different transform that makes this one ambiguous, or else the best different one."""
    rivals: Tuple[Pose, ...] = ()
    """With AMBIGUOUS: the different transforms, best first, that could as well be the true one."""
    words: str = ""
    """Why a meeting was not believed."""
    covariance: Optional[Covariance] = None
    """Of the transform, where it is accepted by a Job."""
    lookalike: float = 0.0
    """Wall of the longest fit with few contradictions that differs, relative to this one's. Buildings whose parts are
    copies of one another show it by long fits elsewhere."""

    @property
    def accepted(self) -> bool:
        """True if the transform may be used."""
        return self.verdict is Verdict.ACCEPTED


def judge(evidence: Evidence, criteria: Criteria) -> Verdict:
    """Verdict on one transform by itself, without rivals."""
    if evidence.matched < criteria.matched:
        return Verdict.TOO_LITTLE_SHARED_WALL
    if evidence.conflict > criteria.conflict:
        return Verdict.CONTRADICTED
    if evidence.minor < criteria.minor:
        return Verdict.ONE_DIRECTION_ONLY
    if evidence.explained < criteria.explained:
        return Verdict.UNEXPLAINED
    return Verdict.ACCEPTED


def believed_alone(result: Registration) -> bool:
    """True if the walls, without a meeting, are enough to believe an accepted transform: much wall and, unless a prior
    excludes copies, nothing that shows a building of copies."""
    strong = judge(result.evidence, STRONG_CRITERIA) is Verdict.ACCEPTED
    return result.accepted and strong and (result.prior or result.lookalike <= LARGEST_LOOKALIKE)


def judge_kept(evidence: Evidence) -> Verdict:
    """Verdict on a transform that is in force. A contradiction counts however little is left of the shared walls: the
    frame of a robot that jumped or was set down elsewhere shares nothing with the former one."""
    if evidence.against >= REFUTING_WALL and evidence.conflict > KEEP_CRITERIA.conflict:
        return Verdict.CONTRADICTED
    return judge(evidence, KEEP_CRITERIA)


def register(
    target: Landmarks,
    source: Landmarks,
    criteria: Criteria = DEFAULT_CRITERIA,
    limits: Limits = UNLIMITED,
    prior: Optional[Prior] = None,
) -> Registration:
    """Finds the transform source -> target by correlation, or declines."""
    return choose(target, source, searched(target, source, prior), (criteria,), limits, prior)


def choose(
    target: Landmarks,
    source: Landmarks,
    starts: List[Pose],
    rule: Rule,
    limits: Limits,
    prior: Optional[Prior],
) -> Registration:
    """Refines every start, ranks them by evidence and decides whether the best one can be believed."""
    ranked = ranked_by_evidence(target, source, starts)
    if not ranked:
        return Registration(Verdict.NO_CANDIDATE)
    _, transform = ranked[0]
    transform = refined(target.surface, subsample(source.surface, 2500), transform, FINE_REACH)
    evidence = compare(target, source, transform)
    points = source.surface.points
    others = [
        Rival(other, its, float(np.median(displacement(transform, other, points))))
        for its, other in ranked[1:]
        if _different(transform, other, points)
    ]
    serious = [other for other in others if any(_rivals(evidence, other.evidence, criteria) for criteria in rule)]
    verdict = verdict_of(evidence, [other.evidence for other in others], rule)
    if verdict is Verdict.ACCEPTED and not limits.allow(transform):
        verdict = Verdict.BEYOND_LIMITS
    if verdict is Verdict.ACCEPTED and prior is not None and not _near_prior(transform, prior, points):
        verdict = Verdict.NO_CANDIDATE
    surveyed, rival = target.surface.length + source.surface.length, next(iter(serious or others), None)
    rivals = tuple(each.transform for each in serious) if verdict is Verdict.AMBIGUOUS else ()
    alike = (other.evidence.matched for other in others if other.evidence.conflict <= FEW_CONFLICTS)
    return Registration(
        verdict,
        transform,
        evidence,
        surveyed,
        prior is not None,
        rival=rival,
        rivals=rivals,
        lookalike=max(alike, default=0.0) / max(evidence.matched, 1e-9),
    )


def searched(target: Landmarks, source: Landmarks, prior: Optional[Prior]) -> List[Pose]:
    """Coarse transforms, one of which should be near the true one: what the search finds."""
    return [candidate.transform for candidate in candidates(target, source, 16 if prior is None else 8, prior)]


def verdict_of(evidence: Evidence, rivals: Sequence[Evidence], rule: Rule) -> Verdict:
    """ACCEPTED if the evidence is enough for one of the rule's criteria beside that of the transforms that differ, else
    what the first of them misses."""
    verdicts = []
    for criteria in rule:
        verdict = judge(evidence, criteria)
        if verdict is Verdict.ACCEPTED and any(_rivals(evidence, other, criteria) for other in rivals):
            verdict = Verdict.AMBIGUOUS
        verdicts.append(verdict)
    if Verdict.ACCEPTED in verdicts:
        return Verdict.ACCEPTED
    return Verdict.AMBIGUOUS if Verdict.AMBIGUOUS in verdicts else verdicts[0]


def follow(target: Landmarks, source: Landmarks, transform: Pose) -> Tuple[Pose, Evidence]:
    """An accepted transform refined on the present maps, and what speaks for it now."""
    better = refined(target.surface, subsample(source.surface, 2500), transform, FINE_REACH)
    return better, compare(target, source, better)


def ranked_by_evidence(target: Landmarks, source: Landmarks, starts: List[Pose]) -> List[Tuple[Evidence, Pose]]:
    """Every start refined, and what speaks for it, the best first."""
    sample = subsample(source.surface, 500)
    target_sample, source_sample = (subsample(part.surface, _RANKED_POINTS) for part in (target, source))
    result = []
    for start in starts:
        transform = refined(target.surface, sample, start, COARSE_REACH)
        result.append((compare_samples(target, source, target_sample, source_sample, transform), transform))
    result.sort(key=lambda pair: -pair[0].score)
    return result


def _rivals(best: Evidence, other: Evidence, criteria: Criteria) -> bool:
    """True if the other transform could as well be the true one: as good, or shorter but without contradictions."""
    plausible = other.conflict <= PLAUSIBLE_CONFLICT and other.matched >= max(
        criteria.plausible_wall, criteria.plausible * best.matched
    )
    doubtful = other.conflict <= FEW_CONFLICTS and other.matched >= criteria.doubtful * best.matched
    return plausible or doubtful or other.score > criteria.rival * best.score


def _different(first: Pose, second: Pose, points: np.ndarray) -> bool:
    return (
        rotation_between(first, second) > math.radians(4.0)
        or float(np.median(displacement(first, second, points))) > 0.4
    )


def _near_prior(transform: Pose, prior: Prior, points: np.ndarray) -> bool:
    centre = points.mean(axis=0, keepdims=True)
    return (
        rotation_between(transform, prior.transform) <= prior.rotation + math.radians(3.0)
        and float(displacement(transform, prior.transform, centre)[0]) <= prior.distance + 0.5
    )
