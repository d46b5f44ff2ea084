"""What robots got to know of a world over time, by their own maps: since when each knows each reference cell."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mr_grid import OccupancyGrid, Pose
from mr_measures.figures import overlap_between_robots
from mr_measures.record.series import TeamSeries
from mr_measures.truth import CELL_AREA, Truth

PERIOD = 5.0  # s between two samples of what a team knows


class Knowledge:
    """Of one robot. `since`: (N,) s at which its map was first seen to know each reference cell, infinite if never."""

    def __init__(self, truth: Truth, start: Pose) -> None:
        """`start`: true, world frame."""
        self._places = start.apply_inverse(truth.reference)
        self.since = np.full(len(truth.reference), np.inf)

    def look(self, own: OccupancyGrid, now: float) -> None:
        known = own.values_at(self._places) >= 0
        self.since[known] = np.minimum(self.since[known], now)


def team_series(since: Sequence[np.ndarray], begin: float, end: float) -> TeamSeries:
    """Of a mission that lasted from `begin` to `end`, on the clock of `since` (N,) of each robot, s."""
    times = np.append(np.arange(0.0, end - begin - 1e-6, PERIOD), end - begin)
    first = np.sort(np.minimum.reduce(list(since)) - begin)
    count = np.searchsorted(first, times, side="right")
    shares = count / len(first) if len(first) else np.zeros(len(times))
    return TeamSeries(
        time=tuple(times.round(4).tolist()),
        explored=tuple((count * CELL_AREA).round(3).tolist()),
        coverage=tuple(shares.round(5).tolist()),
    )


def overlap_of(since: Sequence[np.ndarray], end: float) -> float:
    """Overlap between robots by what each knew itself until `end`."""
    return round(overlap_between_robots([one <= end for one in since]), 5)
