"""What each robot would have seen of the other if a transform were right."""

import math
from typing import NamedTuple

import numpy as np

from .candidates import Candidate
from .identity import is_empty
from .pairing import Pairs
from .sightings import Sightings
from .sweeps import Sweeps
from .tracking import at_times
from .values import Sensor

_UNSEEN_AT_LEAST = 10
_UNSEEN_SHARE = 0.2
_VIEW_MARGIN = math.radians(15.0)


class Looks(NamedTuple):
    """At the times of the own sweeps: where the other told that it was (complex (n,), its yaw (n,)) and where the own
    robot was, each in its own frame, and whether that is known."""

    sweeps: Sweeps
    told: np.ndarray
    yaw: np.ndarray
    told_known: np.ndarray
    own: np.ndarray
    own_known: np.ndarray


def looks_of(sightings: Sightings) -> Looks:
    """Where both robots were when the own one looked."""
    times, told = sightings.sweeps.times, sightings.told
    yaw = np.zeros(len(times))
    if len(told):
        yaw = told[np.clip(np.searchsorted(told[:, 0], times), 0, len(told) - 1), 3]
    places, known = at_times(told, times)
    return Looks(sightings.sweeps, places, yaw, known, *at_times(sightings.own, times))


def stands(candidate: Candidate, looks: Looks) -> bool:
    """False if own scans show nothing where the other robot should be."""
    return not is_empty(looks.sweeps, candidate.turn * looks.told + candidate.shift, looks.told_known)


def unseen(sightings: Sightings, pairs: Pairs, candidate: Candidate, looks: Looks) -> bool:
    """True if the other, with a free line of sight, sees nothing where the own robot should be."""
    if sightings.sensor.farthest <= 0.0:
        return False
    seen = looks.sweeps.look(candidate.turn * looks.told + candidate.shift, looks.told_known)
    should = looks.sweeps.times[seen.there & _in_view(sightings.sensor, candidate, looks)]
    if len(should) < _UNSEEN_AT_LEAST:
        return False
    back = np.sort(pairs.time[candidate.agree & ~pairs.seen_by_own])
    saw = np.searchsorted(back, should + 1.5) > np.searchsorted(back, should - 1.5)
    return bool(saw.mean() < _UNSEEN_SHARE)


def _in_view(sensor: Sensor, candidate: Candidate, looks: Looks) -> np.ndarray:
    """Whether the own robot was well within the other's field of view."""
    own = (looks.own - candidate.shift) * candidate.turn.conjugate()
    seen = (own - looks.told) * np.exp(-1j * looks.yaw)
    near, far = max(sensor.nearest, 0.3) + 0.3, min(sensor.farthest, 5.0) - 0.4
    inside = (np.abs(seen) > near) & (np.abs(seen) < far)
    return looks.own_known & inside & (np.abs(np.angle(seen)) < 0.5 * sensor.view - _VIEW_MARGIN)
