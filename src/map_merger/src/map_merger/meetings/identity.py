"""Whether what was seen may have been somebody else who is heard, too."""

from typing import Mapping, Tuple

import numpy as np

from mr_grid import Pose

from .fitting import fits_of, moments_of
from .sweeps import Sweeps
from .tracking import at_times

_ALIKE_M = 0.1
_HERE_M = 0.35
_LONGEST_GUESS = 3.0
"""A fit to a way of some length tells where to look for the robot within so many times that length."""
_SHORTEST_M = 0.1
_EMPTY_AT_LEAST = 4
_EMPTY_SHARE = 0.2


def is_empty(sweeps: Sweeps, places: np.ndarray, known: np.ndarray) -> bool:
    """True if the sweeps show again and again that nothing stands at the places (complex (n,), one for each)."""
    seen = sweeps.look(places, known)
    empty, there = int(seen.empty.sum()), int(seen.there.sum())
    return empty >= _EMPTY_AT_LEAST and empty > _EMPTY_SHARE * (empty + there)


def who_moves_alike(
    others: Mapping[str, np.ndarray], times: np.ndarray, seen: np.ndarray, error: float, sweeps: Sweeps
) -> str:
    """A robot among `others` (tracks in their own frames) whose way may have been seen as `seen` (complex (n,), m), or
    ''. error: m, of the robot that it is taken for. sweeps: of the robot that saw it."""
    for name, track in others.items():
        places, known = at_times(track, times)
        if known.sum() < max(3, 0.5 * len(times)):
            continue
        fit = fits_of(moments_of(places[known], seen[known], np.zeros(int(known.sum()), np.intp), 1))
        if float(fit.error[0]) >= max(_ALIKE_M, 2.0 * error):
            continue
        spread = float(fit.spread[0])
        if spread > _SHORTEST_M:
            ways, there = at_times(track, sweeps.times)
            near = np.abs(ways - places[known].mean()) < _LONGEST_GUESS * spread
            if is_empty(sweeps, fit.turn[0] * ways + fit.shift[0], there & near):
                continue
        return name
    return ""


def who_was_there(placed: Mapping[str, Tuple[np.ndarray, Pose]], times: np.ndarray, seen: np.ndarray) -> str:
    """A robot whose transform is known (its track, and that to the frame of `seen`) that was where something was seen,
    or ''."""
    for name, (track, transform) in placed.items():
        places, known = at_times(track, times)
        if not known.any():
            continue
        turn, shift = np.exp(1j * transform.yaw), complex(transform.x, transform.y)
        if float(np.median(np.abs(turn * places[known] + shift - seen[known]))) < _HERE_M:
            return name
    return ""
