"""What a robot remembers of places where it got stuck."""

import math
from typing import Dict, Tuple

from mr_sim.pose import Pose

Point = Tuple[float, float]

PLACE = 0.5  # m around a recovery that are the same place
FORGOTTEN = 60.0  # s after the last recovery there


class StuckPlaces:
    """Counts recoveries by place, whatever the goal was: a robot that is given another goal is as stuck as before."""

    def __init__(self) -> None:
        self._counts: Dict[Point, Tuple[int, float]] = {}  # recoveries there, time of the last, s

    def add(self, now: float, pose: Pose) -> int:
        """Notes a recovery; how many there have been at this place lately, with this one."""
        self._counts = {
            place: (count, last) for place, (count, last) in self._counts.items() if 0.0 <= now - last < FORGOTTEN
        }
        near = [place for place in self._counts if math.dist(place, pose[:2]) < PLACE]
        place = min(near, key=lambda place: math.dist(place, pose[:2])) if near else (pose[0], pose[1])
        count = self._counts[place][0] + 1 if near else 1
        self._counts[place] = (count, now)
        return count
