"""Whether a robot that has ended goes on, because a map shows something new."""

import math
from typing import Optional

from explorer.perception import Perception
from explorer.scene import Scene
from explorer.senses import Senses

PERIOD = 2.0  # s between two looks at the map after the end
MOST_REOPENINGS = 5  # in a mission


class Reopening:
    """Openings count that nobody claims and that are there for `delay` seconds. Bounded: a robot comes to an end."""

    def __init__(self, delay: float, perception: Perception, senses: Senses) -> None:
        self._delay, self._perception, self._senses = delay, perception, senses
        self._looked_at = -math.inf
        self._wanted_since: Optional[float] = None
        self._count = 0

    def due(self, now: float) -> bool:
        """It is time to look at the map again."""
        if now - self._looked_at < PERIOD or self._count >= MOST_REOPENINGS:
            return False
        self._looked_at = now
        return True

    def wanted(self, scene: Scene) -> bool:
        """True if the robot is to go on."""
        free = (cluster for cluster in scene.open if cluster.number not in scene.claimed)
        if not any(self._perception.is_opening(cluster) for cluster in free):
            self._wanted_since = None
            return False
        if self._wanted_since is None:
            self._wanted_since = scene.now
        if scene.now - self._wanted_since < self._delay:
            return False
        self._count += 1
        self._wanted_since = None
        return True
