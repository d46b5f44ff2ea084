"""Decision on two maps alone: no sightings, no later maps, no team. What the command line and the benchmark judge by.

Two maps alone cannot tell a room from an exact copy of it that neither map shows. What can be told is whether one of
them holds a copy: then two transforms fit, and the pair is declined. A robot asks for more before it believes;
here `confidence_in` says how much wall, how little contradiction and which rival there was.
"""

from typing import Optional

from .confidence import confidence_of, place_of_two_maps
from .covariance import covariance_of
from .registration import ONCE_PRIOR_RULE, ONCE_RULE, Criteria, Registration, register_once
from .search import Prior
from .surface import Landmarks


def criteria_for(prior: Optional[Prior]) -> Criteria:
    """What a transform must show."""
    return (ONCE_RULE if prior is None else ONCE_PRIOR_RULE)[0]


def decide(target: Landmarks, source: Landmarks, prior: Optional[Prior] = None) -> Registration:
    """The transform source -> target with its covariance, or why there is none."""
    result = register_once(target, source, prior=prior)
    if not result.accepted or result.transform is None:
        return result
    return result._replace(covariance=covariance_of(target, source, result.transform))


def confidence_in(result: Registration) -> float:
    """Confidence in what was decided, 0 to 1; 0 if nothing was accepted."""
    if not result.accepted or result.covariance is None:
        return 0.0
    return confidence_of(result.covariance, place_of_two_maps(result))
