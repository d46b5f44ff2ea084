"""When to try again."""

import math


class Retry:
    """Spaces repeated requests: the pause doubles from `first` to `longest` seconds until there is progress."""

    def __init__(self, first: float, longest: float) -> None:
        self._first, self._longest = first, max(first, longest)
        self._pause = first
        self._due = -math.inf

    def ready(self, now: float) -> bool:
        """True once a pause has passed or the clock has jumped back; starts the next, longer pause."""
        if now < self._due <= now + self._longest:
            return False
        self._due = now + self._pause
        self._pause = min(2.0 * self._pause, self._longest)
        return True

    def progress(self) -> None:
        """Something arrived: the next pauses are short again."""
        self._pause = self._first

    def at_once(self) -> None:
        """The other side is back: no pause before the next try."""
        self._pause, self._due = self._first, -math.inf
