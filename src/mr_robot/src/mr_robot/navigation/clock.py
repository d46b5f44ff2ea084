"""Time that only goes on."""


class Clock:
    """A clock that is set back makes no deadline late and no memory last."""

    def __init__(self) -> None:
        self._last = float("-inf")
        self._offset = 0.0

    def __call__(self, now: float) -> float:
        """s; what has passed since an earlier call, 0 where `now` was set back."""
        if now < self._last:
            self._offset += self._last - now
        self._last = now
        return now + self._offset
