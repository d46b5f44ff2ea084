"""When to try again."""

import math


class Retry:
    """Spaces tries: after `steady` pauses of `first` seconds each next one is twice as long, up to `longest`, until
    there is progress."""

    def __init__(self, first: float, longest: float, steady: int = 1) -> None:
        self._first, self._longest, self._steady = first, max(first, longest), steady
        self._tries = 0
        self._due = -math.inf

    def ready(self, now: float) -> bool:
        """True once a pause has passed or the clock has jumped back; starts the next pause."""
        if now < self._due <= now + self._longest:
            return False
        self._tries = min(self._tries + 1, self._steady + 64)
        self._due = now + min(self._first * 2.0 ** max(0, self._tries - self._steady), self._longest)
        return True

    def progress(self, now: float) -> None:
        """Something arrived: the pauses, the present one too, are short again."""
        self._tries = 0
        self._due = min(self._due, now + self._first)

    def at_once(self) -> None:
        """The other side is back: no pause before the next try."""
        self._tries, self._due = 0, -math.inf
