"""What time it is in a mission."""

from __future__ import annotations

import statistics
from typing import Sequence

SILENCE = 5.0  # s of real time after which the trace has ended, as on a full disk


class MissionClock:
    """Simulation time (s) by the trace of the world; where that ends, by the robots' own clocks, of which most are
    right."""

    def __init__(self) -> None:
        self.time = 0.0
        self._trace = 0.0
        self._since: float | None = None

    def update(self, trace: float, robots: Sequence[float], now: float) -> None:
        """`trace`: latest time in it; `robots`: as each says; `now`: real time, s."""
        if trace > self._trace or self._since is None:
            self._trace, self._since = trace, now
            self.time = max(self.time, trace)
        elif now - self._since > SILENCE and robots:
            self.time = max(self.time, statistics.median_low(robots))
