"""Transforms that lay what two robots saw of each other on what they tell: found, fitted, and the same ones joined."""

import math
from typing import List, NamedTuple, Optional, Tuple

import numpy as np

from .fitting import Fits, Moments, fits_of, fitted, moments_of
from .pairing import Pairs

FEWEST_AGREEING = 5
_REACH_M = 0.15
"""A sighting farther from where it should be is of something else."""
_SEED_ERROR_M = 0.12
_SEED_SPREAD_M = 0.12
_MOST_SEEDS = 40
_MOST_CANDIDATES = 12
_SAME_M = 0.25
_SAME_TURN = math.radians(10.0)


class Candidate(NamedTuple):
    """A transform target = turn * source + shift, and the pairs that agree with it (bool (n,)). sightings: that these
    stand for. error: their root mean square distance, m. unseen: the other should have seen the own robot and did not.
    """

    turn: complex
    shift: complex
    agree: np.ndarray
    sightings: float
    error: float
    unseen: bool = False


def candidates_of(pairs: Pairs) -> List[Candidate]:
    """The distinct transforms that pairs suggest, best supported first."""
    found = [_candidate(pairs, turn, shift) for turn, shift in _seeds(pairs)]
    return _distinct([each for each in found if each is not None], pairs)


def _seeds(pairs: Pairs) -> List[Tuple[complex, complex]]:
    """Transforms to begin with: from each fragment that has an extent, and from every two of both robots."""
    if not pairs.fragments:
        return []
    sums = moments_of(pairs.source, pairs.target, pairs.label, pairs.fragments)
    own, told = _part(sums, slice(0, pairs.own)), _part(sums, slice(pairs.own, None))
    both = Moments(*(mine[:, None] for mine in own)).plus(Moments(*(theirs[None, :] for theirs in told)))
    recent = _recent(pairs)
    seeds: List[Tuple[float, complex, complex]] = []
    for moments in (sums, both, recent):
        seeds += _usable(fits_of(moments), moments.weight)
    seeds.sort(key=lambda seed: seed[0])
    return [(turn, shift) for _, turn, shift in seeds[:_MOST_SEEDS]]


def _recent(pairs: Pairs, knots: int = 10) -> Moments:
    """Of the latest knots of each fragment: before, it may have followed something else."""
    rank = np.zeros(len(pairs.label), int)
    ends = np.append(np.flatnonzero(np.diff(pairs.label)), len(pairs.label) - 1)
    rank = ends[np.searchsorted(ends, np.arange(len(rank)))] - np.arange(len(rank))
    late = rank < knots
    return moments_of(pairs.source[late], pairs.target[late], pairs.label[late], pairs.fragments)


def _part(moments: Moments, part: slice) -> Moments:
    return Moments(*(values[part] for values in moments))


def _usable(fits: Fits, count: np.ndarray) -> List[Tuple[float, complex, complex]]:
    good = (fits.error < _SEED_ERROR_M) & (fits.spread > _SEED_SPREAD_M) & (count >= 2)
    uncertain = fits.error[good] / fits.spread[good]
    return list(zip(uncertain.tolist(), fits.turn[good].tolist(), fits.shift[good].tolist()))


def _candidate(pairs: Pairs, turn: complex, shift: complex) -> Optional[Candidate]:
    """The transform fitted to all that agrees with it; None if next to nothing does."""
    agree = np.zeros(len(pairs.source), bool)
    for reach in (1.5 * _REACH_M, _REACH_M, _REACH_M):
        agree = np.abs(turn * pairs.source + shift - pairs.target) < reach
        if agree.sum() < 2:
            return None
        turn, shift = fitted(pairs.source[agree], pairs.target[agree])
    sightings = float(pairs.sightings[agree].sum())
    if sightings < FEWEST_AGREEING:
        return None
    error = float(np.sqrt(np.mean(np.abs(turn * pairs.source + shift - pairs.target)[agree] ** 2)))
    return Candidate(turn, shift, agree, sightings, error)


def _distinct(found: List[Candidate], pairs: Pairs) -> List[Candidate]:
    """The best supported of those that are about the same, at most _MOST_CANDIDATES."""
    kept: List[Candidate] = []
    for each in sorted(found, key=lambda each: (-each.sightings, each.error)):
        if len(kept) < _MOST_CANDIDATES and all(_different(each, other, pairs) for other in kept):
            kept.append(each)
    return kept


def _different(first: Candidate, second: Candidate, pairs: Pairs) -> bool:
    middle = pairs.source[first.agree].mean()
    distance = abs(first.turn * middle + first.shift - second.turn * middle - second.shift)
    return distance > _SAME_M or abs(float(np.angle(first.turn * second.turn.conjugate()))) > _SAME_TURN
