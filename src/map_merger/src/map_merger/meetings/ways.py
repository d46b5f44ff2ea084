"""The ways on which two robots saw each other drive, and who else may have driven them."""

import math
from typing import List, NamedTuple, Tuple

import numpy as np

from mr_grid import Pose

from .candidates import Candidate
from .fitting import transform_from
from .identity import who_moves_alike, who_was_there
from .pairing import Pairs
from .sightings import Sightings
from .sweeps import NO_SWEEPS

FEWEST_OF_EACH = 3
"""Sightings on either side that make a straight drive unmistakable."""
PROBATION_S = 1.5
"""A way must have been unmistakable for so long, in time of sightings, and must have agreed ever since."""
OUT_OF_SIGHT_S = 6.0
"""Or it must have been so long ago."""


class Way(NamedTuple):
    """What one robot saw of the other's way. length, width: m. alike: a further robot that moved alike, or ''."""

    length: float
    width: float
    alike: str


def ways_of(sightings: Sightings, pairs: Pairs, candidate: Candidate) -> List[Way]:
    """Without the last moments: what has just begun to differ still agrees."""
    result = []
    proven = _proven(sightings, pairs, candidate)
    for mine in (True, False):
        chosen = proven & (pairs.seen_by_own == mine)
        if chosen.sum() < 3:
            continue
        told, seen = (pairs.source, pairs.target) if mine else (pairs.target, pairs.source)
        alike = _alike(sightings, candidate, mine, pairs.time[chosen], seen[chosen])
        result.append(Way(*_extent(told[chosen]), alike))
    return result


def seen_by_both(sightings: Sightings, pairs: Pairs, candidate: Candidate) -> bool:
    """True if each saw the other where the transform says, not in the last moments only."""
    proven = _proven(sightings, pairs, candidate)
    each = [float(pairs.sightings[proven & (pairs.seen_by_own == mine)].sum()) for mine in (True, False)]
    return min(each) >= FEWEST_OF_EACH


def _proven(sightings: Sightings, pairs: Pairs, candidate: Candidate) -> np.ndarray:
    last = float(pairs.time[candidate.agree].max())
    now = float(sightings.own[-1, 0]) if len(sightings.own) else last
    return candidate.agree & (pairs.time <= max(last - PROBATION_S, now - OUT_OF_SIGHT_S))


def _extent(way: np.ndarray) -> Tuple[float, float]:
    """Length and width, in m, of places (complex (n,))."""
    plane = np.column_stack([way.real, way.imag])
    plane -= plane.mean(axis=0)
    _, axes = np.linalg.eigh(plane.T @ plane)
    width, length = np.ptp(plane @ axes, axis=0).tolist()
    return length, width


def bend_of(ways: List[Way]) -> float:
    """m by which the ways, of those that no further robot can have driven, differ from straight lines."""
    return math.hypot(*(way.width for way in ways if not way.alike))


def _alike(sightings: Sightings, candidate: Candidate, mine: bool, times: np.ndarray, seen: np.ndarray) -> str:
    """A further robot that may have been seen as what was seen, or ''. mine: it was the own robot that saw."""
    to_own = transform_from(candidate.turn, candidate.shift)
    to_viewer = Pose() if mine else to_own.inverse()
    placed = {
        name: (sightings.others[name], to_viewer.compose(transform))
        for name, transform in sightings.placed.items()
        if name in sightings.others
    }
    unplaced = {name: track for name, track in sightings.others.items() if name not in placed}
    sweeps = sightings.sweeps if mine else NO_SWEEPS
    return who_was_there(placed, times, seen) or who_moves_alike(unplaced, times, seen, candidate.error, sweeps)
