"""Periods, and the age of what is dated."""

from typing import Optional

LONGEST_AGE_S = 0.5
"""What is dated farther back is taken to be so old: its clock may be another one."""


def time_of(stamp: float, now: float) -> float:
    """When something dated `stamp` was measured, s: not after `now` and at most LONGEST_AGE_S before.

    In the order of the stamps, whatever clock they are of.
    """
    return min(now, max(stamp, now - LONGEST_AGE_S))


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
