"""Which transforms between two robots' frames their sightings suggest, and what speaks for and against each."""

from typing import Tuple

import numpy as np

from .candidates import FEWEST_AGREEING, Candidate, candidates_of
from .doubts import doubts_of_fit, doubts_of_motion
from .fitting import covariance_of, transform_from
from .looks import looks_of, stands, unseen
from .pairing import Pairs, paired
from .sightings import Sightings
from .values import Hypothesis
from .ways import bend_of, ways_of

_DEVIATION_M = 0.05
"""Of a sighting: the laser sees surfaces, poses and times are not exact."""
_MOST_KEPT = 6


def hypotheses_of(sightings: Sightings) -> Tuple[Hypothesis, ...]:
    """The transforms that are not refuted, best supported first."""
    pairs = paired(sightings.told, sightings.objects, sightings.own, sightings.told_objects)
    looks = looks_of(sightings)
    standing = [each for each in candidates_of(pairs) if stands(each, looks)]
    checked = [each._replace(unseen=unseen(sightings, pairs, each, looks)) for each in standing]
    return tuple(_weighed(sightings, pairs, each) for each in checked[:_MOST_KEPT])


def _weighed(sightings: Sightings, pairs: Pairs, candidate: Candidate) -> Hypothesis:
    agree = candidate.agree
    source = pairs.source[agree]
    ways = ways_of(sightings, pairs, candidate)
    mutual = bool((agree & pairs.seen_by_own).any() and (agree & ~pairs.seen_by_own).any())
    seconds = float(np.ptp(pairs.time[agree]))
    middle = complex(source.mean())
    share = _share(pairs, agree)
    doubts = doubts_of_motion(sightings.robot, ways, candidate) or doubts_of_fit(
        sightings.robot, share, seconds, candidate
    )
    return Hypothesis(
        transform_from(candidate.turn, candidate.shift),
        covariance_of(source, _DEVIATION_M),
        (middle.real, middle.imag),
        int(candidate.sightings),
        candidate.error,
        seconds,
        max((way.length for way in ways), default=0.0),
        bend_of(ways),
        mutual,
        share,
        doubts,
    )


def _share(pairs: Pairs, agree: np.ndarray) -> float:
    """Of what was seen of the objects that agree at some time, the part that agrees."""
    per_object = np.bincount(pairs.label[agree], pairs.sightings[agree], pairs.fragments)
    objects = per_object >= FEWEST_AGREEING
    seen = np.bincount(pairs.label, pairs.sightings, pairs.fragments)
    return float(per_object[objects].sum() / max(seen[objects].sum(), 1.0))
