"""When to try again to find the transform between two maps."""

import math
from typing import Hashable, Optional, Tuple

import numpy as np

from mr_grid import UNKNOWN

from .job import Versioned

LONGEST_PAUSE_S = 10.0
_PAUSE_GROWTH = 1.3
_MAP_GROWTH = 1.03
_MAP_GROWTH_CELLS = 50


class Attempts:
    """The last try at a pair of maps and the pause after it, which grows while tries are in vain."""

    def __init__(self) -> None:
        self._tried: Optional[Tuple[Hashable, Hashable]] = None
        self._cells: Tuple[int, ...] = (0, 0)
        self._news = 0
        self._period = 0.0
        self._pause = 0.0
        self._started = -math.inf

    def due(self, now: float, target: Versioned, source: Versioned, news: int, believed: bool, pressing: bool) -> bool:
        """See `Alignment.due`. believed: there is a transform to look after, so any change of a map counts."""
        if news > self._news or pressing:
            return not self._pausing(now, self._period)
        if self._pausing(now, self._pause) or (target.key, source.key) == self._tried:
            return False
        return believed or self._grown(target, source)

    def started(
        self, now: float, target: Versioned, source: Versioned, period: float, news: int, believed: bool
    ) -> None:
        """A try is under way."""
        growing = min(max(period, _PAUSE_GROWTH * self._pause), max(period, LONGEST_PAUSE_S))
        self._pause = period if believed or news > self._news else growing
        self._tried, self._cells = (target.key, source.key), _known_cells(target, source)
        self._news, self._period, self._started = news, period, now

    def last(self, now: float) -> float:
        """Time of the last try; minus infinity if there was none, or the clock has jumped back since."""
        return self._started if self._started <= now else -math.inf

    def _pausing(self, now: float, pause: float) -> bool:
        return 0.0 <= now - self._started < pause

    def _grown(self, *maps: Versioned) -> bool:
        return any(
            present > _MAP_GROWTH * before + _MAP_GROWTH_CELLS
            for present, before in zip(_known_cells(*maps), self._cells)
        )


def _known_cells(*maps: Versioned) -> Tuple[int, ...]:
    return tuple(int(np.count_nonzero(each.grid.cells != UNKNOWN)) for each in maps)
