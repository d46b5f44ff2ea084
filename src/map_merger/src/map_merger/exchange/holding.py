"""Which changes of the own map are worth a message of their own."""

import math

from . import bounds


class Holding:
    """Holds changes back for a bounded time, since the edges of many small pieces weigh more than the cells inside.

    A map that grew a lot is told at once, so short ones at the start of a mission are.
    """

    def __init__(self) -> None:
        self._told = -math.inf
        self._since = math.inf

    def worth(self, changed: int, known: int, now: float) -> bool:
        """True if so many changed cells of a map of which so many are known to the others go out now (s)."""
        if not changed:
            self._since = math.inf
            return False
        if now < self._told:
            # The clock jumped back.
            self._told = self._since = -math.inf
        self._since = min(self._since, now)
        news = changed >= bounds.MARGINAL_CELLS and now - self._told >= bounds.HELD_S
        due = news or changed >= bounds.GROWN_SHARE * known or now - self._since >= bounds.MARGINAL_HELD_S
        if due:
            self._told, self._since = now, math.inf
        return due
