"""Why a transform that sightings suggest is not to be believed yet."""

import math
from typing import Iterable, List, Optional, Sequence

from .candidates import Candidate
from .values import Hypothesis
from .ways import Way, bend_of

SHORTEST_PATH_M = 0.3
SHORTEST_BEND_M = 0.12
BEND_PER_ERROR = 10.0
"""A way that is a straight line to within so many times the error of the fit is like those of others. Ways of other
robots that began alike fit to within a fifth of their bend."""
LARGEST_ERROR_M = 0.04
SMALLEST_SHARE = 0.95
SHORTEST_SECONDS = 3.0
FEWEST_SIGHTINGS = 10
RIVAL_SHARE = 0.5


def doubts_of_motion(robot: str, ways: List[Way], both: bool, candidate: Candidate) -> str:
    """Why the ways do not tell the robot from others yet; '' if they do. both: see `seen_by_both`."""
    path = max((way.length for way in ways), default=0.0)
    if path < SHORTEST_PATH_M:
        return f"waits to see {robot} move"
    if bend_of(ways) >= max(SHORTEST_BEND_M, BEND_PER_ERROR * candidate.error):
        return ""
    alike = " and ".join(sorted({way.alike for way in ways if way.alike}))
    if alike:
        return f"{robot} and {alike} move alike"
    if both:
        # A straight drive gives the heading, whoever it is; then the other sees this robot where that says.
        return ""
    return f"waits to see {robot} turn: a straight drive of {path:.1f} m is like others"


def doubts_of_fit(robot: str, share: float, seconds: float, candidate: Candidate) -> str:
    """Why too little agrees with the transform, or not well enough; '' if that is not so. share, seconds: as in
    `Hypothesis`."""
    if candidate.error > LARGEST_ERROR_M:
        return f"what moves is {candidate.error:.2f} m off what {robot} tells"
    if share < SMALLEST_SHARE:
        return f"only {100.0 * share:.0f} % of what moves is where {robot} tells"
    if seconds < SHORTEST_SECONDS or candidate.sightings < FEWEST_SIGHTINGS:
        return f"has seen {robot} {candidate.sightings:.0f} times in {seconds:.1f} s only"
    if candidate.unseen:
        return f"{robot} does not see this robot, though nothing hides it"
    return ""


def rival_of(hypothesis: Hypothesis, others: Iterable[Hypothesis]) -> Optional[Hypothesis]:
    """A different transform for which nearly as much speaks."""
    for other in others:
        if other is not hypothesis and other.samples >= RIVAL_SHARE * hypothesis.samples:
            return other
    return None


def doubts_of(hypotheses: Sequence[Hypothesis]) -> str:
    """Why the first of them is not to be believed yet, in words; '' if nothing speaks against it."""
    if not hypotheses:
        return "not seen"
    best = hypotheses[0]
    rival = rival_of(best, hypotheses)
    if best.settled and rival is not None:
        here, there = (each.transform.apply_point(*best.centre) for each in (best, rival))
        return f"two solutions {math.hypot(here[0] - there[0], here[1] - there[1]):.1f} m apart"
    return best.doubts
