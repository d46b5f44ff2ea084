"""What is to happen when, in virtual time."""

from __future__ import annotations

import heapq
import itertools
import math
from typing import Callable


class Agenda:
    """Calls and their times in s. Calls of one time happen in the order in which they were entered."""

    def __init__(self) -> None:
        self._calls: list[tuple[float, int, Callable[[float], None]]] = []
        self._numbers = itertools.count()

    def at(self, time: float, call: Callable[[float], None]) -> None:
        """`call(time)` is made when `time` has come."""
        heapq.heappush(self._calls, (time, next(self._numbers), call))

    def every(self, period: float, first: float, call: Callable[[float], None]) -> None:
        """At `first` and from then on once per `period`."""

        def again(now: float) -> None:
            call(now)
            self.at(now + period, again)

        self.at(first, again)

    @property
    def next_time(self) -> float:
        """Of the earliest call; infinite if there is none."""
        return self._calls[0][0] if self._calls else math.inf

    def run_due(self, now: float) -> None:
        """Makes the calls due until `now`, also those entered meanwhile."""
        while self._calls and self._calls[0][0] <= now:
            time, _, call = heapq.heappop(self._calls)
            call(time)
