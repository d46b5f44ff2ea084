"""When a robot tells the others its edges: at once when they change, and seldom again for who was not there."""

import math
from typing import Iterable, Optional, Tuple

from ..messages import Boot
from ..transform import rotation_between
from .edges import Edge, EdgeReport

SHORTEST_PAUSE_S = 1.0
REPETITION_S = 10.0
_CHANGE_M = 0.03
_CHANGE_RAD = math.radians(0.3)
_CHANGE_OF_WEIGHT = 0.1


class Telling:
    """What was told last, and when."""

    def __init__(self, robot: str, run: Boot) -> None:
        self._robot, self._run = robot, run
        self._told: Optional[Tuple[Edge, ...]] = None
        self._time = -math.inf

    def begin_run(self, run: Boot) -> None:
        """The own frame is a new one; what comes next is told at once."""
        self._run, self._time = run, -math.inf

    def due(self, edges: Iterable[Edge], now: float) -> Optional[EdgeReport]:
        """The report to send now, if one is due: all of the robot's own edges. Nothing as long as there never was an
        edge. A clock that jumps back makes one due."""
        edges = tuple(edges)
        if self._told is None and not edges:
            return None
        since = now - self._time
        pause = SHORTEST_PAUSE_S if self._told is None or _changed(self._told, edges) else REPETITION_S
        if 0.0 <= since < pause:
            return None
        self._told, self._time = edges, now
        return EdgeReport(self._robot, self._run, edges)


def _changed(told: Tuple[Edge, ...], edges: Tuple[Edge, ...]) -> bool:
    """True if others could come to another conclusion."""
    before = {(edge.target, edge.target_run): edge for edge in told}
    after = {(edge.target, edge.target_run): edge for edge in edges}
    return before.keys() != after.keys() or any(_differ(before[key], after[key]) for key in after)


def _differ(first: Edge, second: Edge) -> bool:
    return (
        math.hypot(first.transform.x - second.transform.x, first.transform.y - second.transform.y) > _CHANGE_M
        or rotation_between(first.transform, second.transform) > _CHANGE_RAD
        or abs(first.weight - second.weight) > _CHANGE_OF_WEIGHT
    )
