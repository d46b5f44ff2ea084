"""Who drives off first where robots that see little start side by side and do not know yet where the others are."""

import math
from typing import Sequence

from explorer.team import Team

NARROW = math.pi  # rad; robots that see less may drive into what stands beside them
APART = 10.0  # s from one robot to the next
LONGEST = 25.0  # s that the last one waits


class Departure:
    """Those whose names sort earlier drive off earlier, until it is known where they are."""

    def __init__(self, name: str, field_of_view: float, team: Team) -> None:
        """`field_of_view`: rad."""
        self._name, self._narrow, self._team = name, field_of_view < NARROW, team

    def awaited(self, since_start: float, now: float) -> Sequence[str]:
        """Robots that are to drive off first, `since_start` s from the start of the mission."""
        if not self._narrow or since_start >= LONGEST:
            return ()
        known = self._team.known()
        earlier = sorted(name for name in known if name < self._name)
        step = min(APART, LONGEST / max(1, len(known)))
        if since_start >= step * len(earlier):
            return ()
        placed = self._team.positions(now)
        return [name for name in earlier if name not in placed]
