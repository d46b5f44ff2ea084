"""Periods."""

from typing import Optional


class Timer:
    """Fires at most once per period; a clock that jumps back restarts it."""

    def __init__(self, period: float, first: float = 0.0) -> None:
        self.period = period
        self._due: Optional[float] = None
        self._first = first

    def fires(self, now: float) -> bool:
        """True if it is due; `now` in seconds."""
        if self._due is None or self._due - now > self.period + self._first + 1.0:
            self._due = now + self._first
        if now < self._due:
            return False
        self._due = now + self.period
        return True
