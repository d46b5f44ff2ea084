"""Whether the best of several hypotheses is to be believed."""

import math
from typing import Iterable, Optional, Sequence

from .values import Hypothesis

RIVAL_SHARE = 0.5


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
