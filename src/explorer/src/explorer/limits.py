"""What ends an exploration though something is left."""

from typing import NamedTuple, Optional


class Limits(NamedTuple):
    """Time of exploration in s and way driven in m after which it ends; 0: none."""

    time: float
    distance: float

    def reached(self, time: float, distance: float) -> Optional[str]:
        """The limit that has been reached after that time in s and way in m, in words."""
        if self.time and time >= self.time:
            return f"time limit of {self.time:g} s reached"
        if self.distance and distance >= self.distance:
            return f"distance limit of {self.distance:g} m reached"
        return None

    @property
    def words(self) -> str:
        found = [f"{limit:g} {unit}" for limit, unit in ((self.time, "s"), (self.distance, "m")) if limit]
        return f"ends after {' or '.join(found)}" if found else "ends at no limit"


NO_LIMITS = Limits(0.0, 0.0)
