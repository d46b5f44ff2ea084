"""Decision on two maps alone: no sightings, no later maps, no team. What the command line and the benchmark judge by.

Two maps alone cannot tell a room from an exact copy of it that neither map shows, nor one half of a symmetric building
from the other, however long the walls. What can be told is whether one of them holds a copy: then two transforms fit,
and the pair is declined. An answer is `sure` where a copy faked it once in 3200 pairs.
"""

import math
from typing import Optional

from .confidence import confidence_of, place_of_two_maps
from .covariance import covariance_of
from .reasons import reason_of
from .registration import UNLIMITED, Criteria, Registration, Rule, Verdict, choose, judge, searched
from .search import Prior
from .surface import Landmarks

ONCE_RULE: Rule = (
    Criteria(matched=7.0, minor=0.5, conflict=0.03, explained=0.35, plausible=0.5, plausible_wall=4.0, doubtful=1.5),
    Criteria(matched=10.0, minor=3.0, conflict=0.05, explained=0.35, rival=0.85, plausible=math.inf, doubtful=1.2),
    Criteria(matched=14.0, minor=2.0, conflict=0.1, rival=0.1, plausible_wall=4.0, doubtful=0.8),
)
"""For two maps alone: little wall without a rival, more wall unless a rival is as good, or, where people have moved
things, walls in free space if hardly anything else fits."""
ONCE_PRIOR_RULE: Rule = (
    Criteria(matched=4.0, minor=0.1, explained=0.35, plausible=0.7, plausible_wall=2.5),
    Criteria(matched=6.0, minor=0.2, explained=0.35, rival=0.8, plausible=math.inf),
    Criteria(matched=3.5, minor=0.3, conflict=0.18, explained=0.33, plausible=0.25, plausible_wall=2.5),
)
"""The same with a prior, which excludes most rivals beforehand."""
SURE_CRITERIA = Criteria(matched=28.0, conflict=0.03)
SURE_LOOKALIKE = 0.3
"""Of a sure answer: the longest fit elsewhere with few contradictions, relative to its own. Halves of symmetric
buildings match without a contradiction in 80 m, but hold parts that resemble one another."""


def criteria_for(prior: Optional[Prior]) -> Criteria:
    """What a transform must show."""
    return (ONCE_RULE if prior is None else ONCE_PRIOR_RULE)[0]


def decide(target: Landmarks, source: Landmarks, prior: Optional[Prior] = None) -> Registration:
    """The transform source -> target with its covariance, or why there is none."""
    rule = ONCE_RULE if prior is None else ONCE_PRIOR_RULE
    result = choose(target, source, searched(target, source, prior), rule, UNLIMITED, prior)
    if not result.accepted or result.transform is None:
        return result
    return result._replace(covariance=covariance_of(target, source, result.transform))


def doubt_of(result: Registration) -> str:
    """Why an accepted answer may be a copy's; empty if it is sure: much wall, hardly anything against it, and nothing
    alike elsewhere."""
    if result.prior:
        return "a prior keeps the search from the copies that there may be elsewhere"
    alone = judge(result.evidence, SURE_CRITERIA)
    if alone is not Verdict.ACCEPTED:
        return reason_of(result._replace(verdict=alone), SURE_CRITERIA)
    if result.lookalike > SURE_LOOKALIKE:
        return f"{100 * result.lookalike:.0f} % of the shared wall fits elsewhere, at most {100 * SURE_LOOKALIKE:g} %"
    return ""


def sure(result: Registration) -> bool:
    """True for an accepted answer that copies hardly ever fake."""
    return result.accepted and not doubt_of(result)


def confidence_in(result: Registration) -> float:
    """Confidence in what was decided, 0 to 1; 0 if nothing was accepted."""
    if not result.accepted or result.covariance is None:
        return 0.0
    return confidence_of(result.covariance, place_of_two_maps(result))
