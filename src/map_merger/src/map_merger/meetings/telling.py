"""When a robot tells its track, and what of it."""

import math
from typing import List, Sequence, Tuple

import numpy as np

from .tracking import Fragment, moves
from .values import MOST_OBJECTS, MOST_POSES, MOST_SAMPLES, ToldObject

FAST_S = 0.3
SLOW_S = 2.0
"""Periods of reports while something moves in sight of somebody, and otherwise."""
_REPEATED_S = 0.6
"""Of a report once more in the next one, in case it was lost."""
_SAMPLE_S = 0.18
_LIVELY_S = 3.0
_LIVELY_M = 0.15
_STILL_M = 0.02
_STILL_RAD = 0.03


class Telling:
    """Spaces the reports of one robot."""

    def __init__(self) -> None:
        self._told_at = -math.inf

    def due(self, now: float, lively: bool) -> bool:
        """True if a report is to be made; a clock that jumped back does not hold it up."""
        return not 0.0 <= now - self._told_at < (FAST_S if lively else SLOW_S)

    def taken(
        self, now: float, own: np.ndarray, objects: Sequence[Fragment]
    ) -> Tuple[np.ndarray, Tuple[ToldObject, ...]]:
        """Poses (k, 4) and objects of a report made now. own: (n, 4: time, x, y, yaw)."""
        since = max(self._told_at, now - SLOW_S) - _REPEATED_S if self._told_at <= now else now - SLOW_S
        self._told_at = now
        poses = _aged(_bends(_spaced(own[own[:, 0] >= since])), now)[-MOST_POSES:]
        chosen = _worth_telling(objects)
        return poses, tuple(ToldObject(each.number, _told(each, since, now)) for each in chosen)

    def lively(self, now: float, own: np.ndarray, objects: Sequence[Fragment]) -> bool:
        """True if an object in sight moves, or the own robot moves with one in sight."""
        recent = own[own[:, 0] >= now - _LIVELY_S]
        if objects and moves(recent, _LIVELY_M):
            return True
        return any(moves(each.samples[each.samples[:, 0] >= now - _LIVELY_S], _LIVELY_M) for each in objects)


def _worth_telling(objects: Sequence[Fragment]) -> List[Fragment]:
    known = [each for each in objects if len(each.samples) >= 3]
    # The oldest numbers stay: an object that comes and goes in the reports is of no use.
    return sorted(known, key=lambda each: (not moves(each.samples, _LIVELY_M), each.number))[:MOST_OBJECTS]


def _told(each: Fragment, since: float, now: float) -> np.ndarray:
    samples = _spaced(each.samples[each.samples[:, 0] >= since])
    if not moves(samples, 0.05):
        samples = samples[-1:]
    return _aged(samples, now)[-MOST_SAMPLES:]


def _spaced(rows: np.ndarray) -> np.ndarray:
    """Rows at least _SAMPLE_S apart, with the last one."""
    if len(rows) < 2:
        return rows
    step = np.floor((rows[-1, 0] - rows[:, 0]) / _SAMPLE_S + 1e-6)
    return rows[np.append(np.diff(step) != 0.0, True)]


def _bends(poses: np.ndarray) -> np.ndarray:
    """Poses without those in the middle of a rest."""
    if len(poses) < 3:
        return poses
    still = (np.hypot(*np.diff(poses[:, 1:3], axis=0).T) < _STILL_M) & (np.abs(np.diff(poses[:, 3])) < _STILL_RAD)
    return poses[np.concatenate([[True], ~(still[:-1] & still[1:]), [True]])]


def _aged(rows: np.ndarray, now: float) -> np.ndarray:
    aged = rows.copy()
    aged[:, 0] = np.maximum(now - rows[:, 0], 0.0)
    return aged
