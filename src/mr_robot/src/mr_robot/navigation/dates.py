"""How old input is; and who is to blame for what is dated ahead: a clock, or a computer that does not keep up."""

import math
from typing import Dict, NamedTuple, Optional

from mr_robot.navigation.options import STANDING

INPUT_AGE = 0.5  # s after which a pose or scan no longer tells where the robot and what around it is


class Look(NamedTuple):
    recent: bool
    complaint: Optional[str]


class Dates:
    """A driver with a clock of its own dates all that it sends ahead. Where a computer does not keep up, a node hears
    of input before it hears what time it is, or is long at work on what it began before: its own steps come late."""

    def __init__(self, period: float) -> None:
        """`period`: s between steps."""
        self._longest = period + INPUT_AGE
        self._stepped_at = math.inf
        self._late_at = -math.inf
        self._late = 0.0  # s between two steps
        self._ahead_since: Dict[str, float] = {}

    def step(self, now: float) -> None:
        """Once per period, `now` by the node's own clock, s."""
        if now - self._stepped_at > self._longest:
            self._late_at, self._late = now, now - self._stepped_at
            self._ahead_since.clear()
        self._stepped_at = now

    def look(self, what: str, stamp: float, now: float) -> Look:
        """Whether input is dated within `INPUT_AGE`, s. What is dated ahead would never grow old."""
        age = now - stamp
        if age >= -INPUT_AGE:
            self._ahead_since.pop(what, None)
            return Look(age <= INPUT_AGE, None)
        since = self._ahead_since.setdefault(what, now)
        told = f"{what} ignored: dated {-age:.1f} s ahead"
        if 0.0 <= now - self._late_at < STANDING:
            return Look(False, f"{told}; control came after {self._late:.1f} s, so this computer does not keep up")
        if 0.0 <= now - since < STANDING:
            return Look(False, None)
        return Look(False, f"{told}; its driver and this node must have one clock")
