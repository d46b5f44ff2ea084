"""Who drives off first where robots that see little start side by side and do not know yet where the others are."""

import math
from typing import Dict, List, Optional, Sequence

import numpy as np

from explorer.grid import OccupancyMap
from explorer.team import Team
from mr_grid import Pose

NARROW = math.pi  # rad; robots that see less may drive into what stands beside them
APART = 10.0  # s from one robot to the next; meanwhile it looks around a metre ahead
ROUND = 2.0  # s that a robot leaves to each one whose name sorts earlier
BOXED_IN = 6.0  # s more, that one with something before it leaves to the others
LONGEST = 60.0  # s that any robot waits
AHEAD = 2.0  # m before a robot in which nothing must stand
SPACING = 0.05  # m between points that are looked at


class Departure:
    """Robots drive off one at a time until it is known where they are. Those that have their way before them go first:
    in a row of robots the one behind would have to squeeze past the one ahead."""

    def __init__(self, name: str, field_of_view: float, radius: float, team: Team) -> None:
        """`field_of_view`: rad. `radius`: m, of the largest robot."""
        self._name, self._radius, self._team = name, radius, team
        self._waits = field_of_view < NARROW
        self._set_off: Dict[str, float] = {}  # s on this robot's clock, first claims

    def awaited(self, started: float, pose: Pose, grid: Optional[OccupancyMap], now: float) -> Sequence[str]:
        """Robots that are to drive off first; `started`: when the mission was. Once there is none there never is."""
        others = self._awaited(started, pose, grid, now) if self._waits else ()
        self._waits = bool(others)
        return others

    def _awaited(self, started: float, pose: Pose, grid: Optional[OccupancyMap], now: float) -> List[str]:
        if now - started >= LONGEST:
            return []
        for name in self._team.claims(now):
            self._set_off.setdefault(name, now)
        placed = self._team.positions(now)
        strangers = [name for name in self._team.known() if name not in placed]
        leaving = [name for name in strangers if now - self._set_off.get(name, -math.inf) < APART]
        if leaving:
            return leaving
        standing = [name for name in strangers if name not in self._set_off]
        free_since = max([started, *(self._set_off[name] + APART for name in strangers if name in self._set_off)])
        earlier = [name for name in standing if name < self._name]
        boxed_in = bool(standing) and not self._way_is_clear(pose, grid)
        if now - free_since >= ROUND * len(earlier) + (BOXED_IN if boxed_in else 0.0):
            return []
        return standing if boxed_in else earlier

    def _way_is_clear(self, pose: Pose, grid: Optional[OccupancyMap]) -> bool:
        if grid is None:
            return True
        reach, width = np.arange(self._radius, AHEAD, SPACING), np.arange(-self._radius, self._radius, SPACING)
        ahead, aside = np.meshgrid(reach, width)
        points = pose.apply(np.column_stack([ahead.ravel(), aside.ravel()]))
        return bool((grid.values_at(points) < OccupancyMap.OCCUPIED_FROM).all())
