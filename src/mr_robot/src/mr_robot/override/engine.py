"""Who drives: a person, as long as one does, else navigation. Knows no ROS and no clock."""

import math
from typing import NamedTuple, Optional

HOLD = 1.0  # s after a person's last command until navigation drives again


class Velocity(NamedTuple):
    """m/s ahead and to the left, rad/s."""

    linear: float = 0.0
    lateral: float = 0.0
    angular: float = 0.0

    @property
    def finite(self) -> bool:
        return all(map(math.isfinite, self))


STANDSTILL = Velocity()


class Override:
    """Every call takes `now` in s and returns the velocity that goes to the base, None for nothing."""

    def __init__(self, hold: float = HOLD) -> None:
        """`hold`: s for which a command of a person holds navigation off. A person who says nothing more for so long,
        or whose radio is lost, has let go: the robot stops, and then navigation may drive."""
        self._hold = hold
        self._taken_at: Optional[float] = None

    @property
    def taken(self) -> bool:
        """A person drives."""
        return self._taken_at is not None

    def on_person(self, velocity: Velocity, now: float) -> Optional[Velocity]:
        if not velocity.finite:
            return None
        self._taken_at = now
        return velocity

    def on_navigation(self, velocity: Velocity, now: float) -> Optional[Velocity]:
        if self.taken or not velocity.finite:
            return None
        return velocity

    def tick(self, now: float) -> Optional[Velocity]:
        """Call it about ten times a second."""
        if self._taken_at is None or 0.0 <= now - self._taken_at < self._hold:
            return None
        self._taken_at = None
        return STANDSTILL
