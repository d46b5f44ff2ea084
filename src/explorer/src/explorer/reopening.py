"""Whether a robot that has ended goes on, because a map shows something new."""

import math
from typing import List, Optional, Tuple

import numpy as np

from explorer.clusters import Cluster
from explorer.heard import SAME_LEFTOVER
from explorer.perception import Perception
from explorer.scene import Scene

PERIOD = 2.0  # s between two looks at the map after the end
MOST_REOPENINGS = 5  # in a mission
MORE_KNOWN = 0.5  # m^2 that the map must show more around a leftover, within a metre, before it is something new


class Reopening:
    """Openings count that nobody claims, that are there for `delay` seconds, and that were not left at the end: the way
    home shows a little more around these, and what was decided about them seems not to hold any more. Bounded: a robot
    comes to an end."""

    def __init__(self, delay: float, perception: Perception) -> None:
        self._delay, self._perception = delay, perception
        self._looked_at = -math.inf
        self._wanted_since: Optional[float] = None
        self._count = 0
        self._left: List[Tuple[float, float, float]] = []  # x and y of leftovers in metres, and m^2 known around them

    def end(self) -> None:
        """The robot has ended."""
        places = [(left.x, left.y) for left in self._perception.leftovers()]
        self._left = [(x, y, self._perception.known_area_near(x, y)) for x, y in places]

    def due(self, now: float) -> bool:
        """It is time to look at the map again."""
        if now - self._looked_at < PERIOD or self._count >= MOST_REOPENINGS:
            return False
        self._looked_at = now
        return True

    def wanted(self, scene: Scene) -> bool:
        """True if the robot is to go on."""
        free = (cluster for cluster in scene.open if cluster.number not in scene.claimed)
        if not any(self._perception.is_opening(cluster) and self._is_new(cluster) for cluster in free):
            self._wanted_since = None
            return False
        if self._wanted_since is None:
            self._wanted_since = scene.now
        if scene.now - self._wanted_since < self._delay:
            return False
        self._count += 1
        self._wanted_since = None
        return True

    def _is_new(self, cluster: Cluster) -> bool:
        near = [
            self._perception.known_area_near(x, y) - known
            for x, y, known in self._left
            if float(np.hypot(*(cluster.points - (x, y)).T).min()) <= SAME_LEFTOVER
        ]
        return all(more > MORE_KNOWN for more in near)
