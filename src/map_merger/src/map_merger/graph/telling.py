"""When a robot tells the others its edges: at once when they change, and seldom again for who was not there."""

import math
from typing import Optional, Tuple

from ..messages import Boot
from .change import Change, differ
from .edges import Edge, EdgeReport

SHORTEST_PAUSE_S = 1.0
REPETITION_S = 10.0
_CHANGE = Change(distance_m=0.03, rotation_rad=math.radians(0.3), weight=0.1, covariance=math.inf)
"""By less nobody comes to another conclusion."""


class Telling:
    """What was told last, and when."""

    def __init__(self, robot: str, run: Boot) -> None:
        self._robot, self._run = robot, run
        self._told: Optional[Tuple[Edge, ...]] = None
        self._time = -math.inf

    def begin_run(self, run: Boot) -> None:
        """The own frame is a new one; what comes next is told at once."""
        self._run, self._time = run, -math.inf

    def due(self, edges: Tuple[Edge, ...], now: float) -> Optional[EdgeReport]:
        """The report to send now, if one is due: all of the robot's own edges. Nothing as long as there never was an
        edge. A clock that jumps back makes one due."""
        if self._told is None and not edges:
            return None
        since = now - self._time
        changed = self._told is None or (edges is not self._told and differ(self._told, edges, _CHANGE))
        if 0.0 <= since < (SHORTEST_PAUSE_S if changed else REPETITION_S):
            return None
        self._told, self._time = edges, now
        return EdgeReport(self._robot, self._run, edges)
