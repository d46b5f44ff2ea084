"""Which transforms between two robots' frames their sightings suggest, and what speaks for and against each."""

import math
from typing import Tuple

import numpy as np

from .candidates import FEWEST_AGREEING, Candidate, candidates_of
from .doubts import doubts_of_fit, doubts_of_motion
from .fitting import covariance_of, transform_from
from .looks import looks_of, stands, unseen
from .pairing import Pairs, paired
from .sightings import Sightings
from .values import Hypothesis
from .ways import bend_of, seen_by_both, ways_of

_DEVIATION_M = 0.05
"""Of a sighting: the laser sees surfaces, poses and times are not exact."""
_MOST_KEPT = 6
_JUMP_SHARE = 0.5
_JUMP_RAD = math.radians(2.5)
"""Standard deviations where SLAM has jumped: of the place, as a share of the jump, and of the heading. In missions of
Turtlebots (seeds 1001 to 1004) jumps are 0.15 to 0.5 m, up to 9 deg; taken out of a track they leave 0.03 m, 4 deg."""


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
    share = _share(pairs, agree)
    both = seen_by_both(sightings, pairs, candidate)
    doubts = doubts_of_motion(sightings.robot, ways, both, candidate) or doubts_of_fit(
        sightings.robot, share, seconds, candidate
    )
    middle = complex(source.mean())
    transform = transform_from(candidate.turn, candidate.shift)
    return Hypothesis(
        sightings.own_map.compose(transform).compose(sightings.told_map.inverse()),
        _covariance(source, sightings.jump),
        sightings.told_map.apply_point(middle.real, middle.imag),
        int(candidate.sightings),
        candidate.error,
        seconds,
        max((way.length for way in ways), default=0.0),
        bend_of(ways),
        mutual,
        share,
        doubts,
    )


def _covariance(source: np.ndarray, jump: float) -> np.ndarray:
    """Of the sightings, and of where a map is of which a part has jumped: its walls have to tell."""
    covariance = covariance_of(source, _DEVIATION_M)
    if jump > 0.0:
        covariance += np.diag([(_JUMP_SHARE * jump) ** 2, (_JUMP_SHARE * jump) ** 2, _JUMP_RAD**2])
    return covariance


def _share(pairs: Pairs, agree: np.ndarray) -> float:
    """Of what was seen of the objects that agree at some time, the part that agrees."""
    per_object = np.bincount(pairs.label[agree], pairs.sightings[agree], pairs.fragments)
    objects = per_object >= FEWEST_AGREEING
    seen = np.bincount(pairs.label, pairs.sightings, pairs.fragments)
    return float(per_object[objects].sum() / max(seen[objects].sum(), 1.0))
