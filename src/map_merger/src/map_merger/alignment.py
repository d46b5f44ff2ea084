"""When a transform between two robots is tried, believed, followed and given up.

A transform is believed at once only with strong evidence; otherwise it must be found again after the maps have grown.
It is then followed as the maps grow. Each look at it adds to its credit or takes from it; without credit it is revoked.
"""

import math
from collections import deque
from dataclasses import dataclass, replace
from typing import Deque, Optional

from mr_grid import Pose

from .attempts import Attempts
from .covariance import Covariance
from .evidence import Evidence
from .job import Versioned
from .reasons import reason_of, unconfirmed_reason
from .registration import (
    DEFAULT_CRITERIA,
    KEEP_CRITERIA,
    PRIOR_CRITERIA,
    SIGHTED_CRITERIA,
    Criteria,
    Registration,
    Verdict,
    believed_alone,
)
from .transform import rotation_between

SHORTEST_GROWTH_M = 3.0
SHORTEST_GROWTH = 1.15
"""The shared walls must have grown by so many metres, and by this factor, before a second look confirms a candidate."""
SURVEY_GROWTH = 1.4
"""Or both maps together by this factor, without a contradiction and without a rival having come up."""
REHABILITATION = 1.5
REHABILITATION_M = 5.0
"""A refuted transform is believed again when it has so many times the shared wall, and so many metres more."""
FIRST_CREDIT = 8
MOST_CREDIT = 12
CREDIT = {Verdict.ACCEPTED: 1, Verdict.CONTRADICTED: -4, Verdict.UNEXPLAINED: -2}
"""What a look adds. Whatever else it ends with, as with too little shared wall or a fault, says nothing..."""
VANISHED = 0.25
"""...but that less than this share is left of shared walls that were enough to find a transform by: maps only grow, so
they leave as much unexplained."""
_MOST_NOT_THERE = 16
"""So many transforms by which the other robot was not where it should have been are remembered: they are believed only
when it is met."""
_SAME_DISTANCE = 0.4
_SAME_ROTATION = math.radians(1.5)


@dataclass(frozen=True)
class Belief:
    """A transform in force. met: the robots saw one another when it was found. most: m of shared wall, the most that
    there ever was."""

    transform: Pose
    evidence: Evidence
    covariance: Optional[Covariance]
    met: bool
    credit: int = FIRST_CREDIT
    most: float = 0.0


class Alignment:
    """What is known about the transform of one robot's frame to the own one."""

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """The robot's frame is a new one: nothing that was known holds."""
        self.verdict = Verdict.NO_CANDIDATE
        self.reason = Verdict.NO_CANDIDATE.value
        """Why there is a transform or none, for people."""
        self._belief: Optional[Belief] = None
        self._candidate: Optional[Registration] = None
        self._refuted: Optional[Belief] = None
        self.suggested: Optional[Pose] = None
        """What the last search found without contradictions, be there ever so little shared wall."""
        self._not_there: Deque[Pose] = deque(maxlen=_MOST_NOT_THERE)
        self._attempts = Attempts()

    @property
    def transform(self) -> Optional[Pose]:
        """The transform that is believed."""
        return None if self._belief is None else self._belief.transform

    @property
    def belief(self) -> Optional[Belief]:
        """The transform that is believed, and why."""
        return self._belief

    @property
    def evidence(self) -> Evidence:
        """What speaks for the transform that is believed."""
        return Evidence() if self._belief is None else self._belief.evidence

    @property
    def proposed(self) -> Optional[Pose]:
        """The transform that is believed or, until one is, the one that waits for confirmation."""
        if self._belief is not None:
            return self._belief.transform
        return None if self._candidate is None else self._candidate.transform

    @property
    def awaits_meeting(self) -> bool:
        """True if the walls have given one or several transforms, and a sighting could decide."""
        return self._belief is None and (self._candidate is not None or self.verdict is Verdict.AMBIGUOUS)

    def due(
        self,
        now: float,
        target: Versioned,
        source: Versioned,
        news: int = 0,
        disputed: bool = False,
        in_sight: bool = False,
    ) -> bool:
        """True if a job is worth its time.

        news: how many pieces of evidence other than the maps there have been, such as sightings. More than at the last
        start make a job due after the plain period, whatever the maps. disputed: the transform and those of the rest of
        the team contradict one another, so it is looked at again after each period: the walls may tell who is wrong.
        in_sight: both robots see something that moves. If it is they, the walls around them may tell where they are.
        """
        pressing = disputed if self._belief is not None else in_sight
        return self._attempts.due(now, target, source, news, self.proposed is not None, pressing)

    def started(self, now: float, target: Versioned, source: Versioned, period: float, news: int = 0) -> None:
        """A job is under way; `period` is the shortest time in seconds to the next one."""
        self._attempts.started(now, target, source, period, news, self.proposed is not None)

    def started_before(self, now: float) -> float:
        """When the last job was started; minus infinity if none was, or the clock has jumped back since."""
        return self._attempts.last(now)

    def finished(self, result: Registration) -> str:
        """Takes the outcome of a job. Returns `accepted`, `moved` or `revoked` if that is the news, else ''."""
        self.verdict, self.reason = result.verdict, reason_of(result, _criteria_of(self._belief, result))
        self.suggested = result.transform if result.evidence.conflict <= SIGHTED_CRITERIA.conflict else None
        return self._found(result) if self._belief is None else self._followed(self._belief, result)

    def refuted(self, words: str) -> str:
        """The rest of the team contradicts the transform, as `words` say: it is revoked and may be searched again, but
        is believed again only with more evidence. Returns `revoked`, or '' if there was none."""
        refuted = self._belief
        if refuted is None:
            return ""
        self.forget()
        self._refuted = refuted
        self.verdict, self.reason = Verdict.CONTRADICTS_TEAM, words
        return "revoked"

    def _found(self, result: Registration) -> str:
        if result.verdict is Verdict.NOT_THERE and result.transform is not None:
            self._candidate = None
            if not any(_agree(each, result.transform) for each in self._not_there):
                self._not_there.append(result.transform)
        if not result.accepted or result.transform is None:
            if result.verdict in (Verdict.CONTRADICTED, Verdict.AMBIGUOUS, Verdict.CONTRADICTS_TEAM):
                self._candidate = None
            return ""
        if not result.met and any(_agree(each, result.transform) for each in self._not_there):
            self.verdict, self.reason = Verdict.NOT_THERE, Verdict.NOT_THERE.value
            return ""
        if self._is_refuted(result):
            self.verdict, self.reason = Verdict.CONTRADICTS_TEAM, "found again what the team contradicts"
            return ""
        if not (result.met or believed_alone(result) or self._confirms(result)):
            if self._candidate is None or not _agree(self._candidate.transform, result.transform):
                self._candidate = result
            self.reason = unconfirmed_reason(result)
            return ""
        self._belief = Belief(
            result.transform, result.evidence, result.covariance, result.met, most=result.evidence.matched
        )
        self._candidate = self._refuted = None
        return "accepted"

    def _is_refuted(self, result: Registration) -> bool:
        refuted = self._refuted
        return (
            refuted is not None
            and _agree(refuted.transform, result.transform)
            and result.evidence.matched
            < max(REHABILITATION * refuted.evidence.matched, refuted.evidence.matched + REHABILITATION_M)
        )

    def _confirms(self, result: Registration) -> bool:
        before = self._candidate
        if before is None or not result.prior or not _agree(before.transform, result.transform):
            return False
        matched = before.evidence.matched
        if result.evidence.matched >= max(matched + SHORTEST_GROWTH_M, matched * SHORTEST_GROWTH):
            return True
        return result.surveyed >= SURVEY_GROWTH * before.surveyed and result.evidence.matched >= 0.95 * matched

    def _followed(self, belief: Belief, result: Registration) -> str:
        credit = min(MOST_CREDIT, belief.credit + _credit_of(belief, result))
        if credit <= 0:
            self.forget()
            self.verdict, self.reason = result.verdict, reason_of(result, KEEP_CRITERIA)
            return "revoked"
        if not result.accepted or result.transform is None:
            self._belief = replace(belief, evidence=result.evidence, credit=credit)
            return ""
        # Only a search, which a look becomes when the map has jumped, has a prior.
        self._belief = Belief(
            result.transform,
            result.evidence,
            result.covariance or belief.covariance,
            belief.met,
            FIRST_CREDIT if result.prior else credit,
            max(belief.most, result.evidence.matched),
        )
        return "moved" if result.prior else ""


def _credit_of(belief: Belief, result: Registration) -> int:
    """What a look adds to the credit of a belief."""
    little = result.verdict in (Verdict.TOO_LITTLE_SHARED_WALL, Verdict.ONE_DIRECTION_ONLY)
    if little and belief.most >= DEFAULT_CRITERIA.matched and result.evidence.matched < VANISHED * belief.most:
        return CREDIT[Verdict.UNEXPLAINED]
    return CREDIT.get(result.verdict, 0)


def _criteria_of(belief: Optional[Belief], result: Registration) -> Criteria:
    """What the result was judged by."""
    if belief is not None:
        return KEEP_CRITERIA
    return PRIOR_CRITERIA if result.prior else DEFAULT_CRITERIA


def _agree(first: Optional[Pose], second: Optional[Pose]) -> bool:
    if first is None or second is None:
        return False
    between = first.inverse().compose(second)
    return math.hypot(between.x, between.y) <= _SAME_DISTANCE and rotation_between(first, second) <= _SAME_ROTATION
