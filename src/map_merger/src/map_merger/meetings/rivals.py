"""Whether the best of several hypotheses is to be believed."""

import math
from typing import Iterable, Optional, Sequence

from ..transform import Transform, rotation_between
from .hypotheses import LARGEST_ERROR_M, SHORTEST_PATH_M, SMALLEST_SHARE
from .values import Hypothesis

RIVAL_SHARE = 0.5
_SAME_M = 0.3
_SAME_TURN = math.radians(4.0)


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


def agrees(hypotheses: Sequence[Hypothesis], transform: Transform) -> bool:
    """True if what was seen of the other's way fits a transform that was found without the sightings. A straight drive,
    like others as it may be, is enough for that."""
    if not hypotheses or rival_of(hypotheses[0], hypotheses) is not None:
        return False
    best = hypotheses[0]
    here, there = (each.apply_point(*best.centre) for each in (best.transform, transform))
    same = math.hypot(here[0] - there[0], here[1] - there[1]) < _SAME_M
    clear = best.path >= SHORTEST_PATH_M and best.error <= LARGEST_ERROR_M and best.share >= SMALLEST_SHARE
    return same and clear and rotation_between(best.transform, transform) < _SAME_TURN
