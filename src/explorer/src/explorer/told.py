"""Places that other robots have explored, each believed until the map had time to show it."""

from typing import List, NamedTuple, Tuple

import numpy as np

# Places that are kept, the newest.
MAXIMUM_TOLD = 2000


class _Told(NamedTuple):
    x: float
    y: float
    until: float
    robot: str


class ToldPlaces:
    """Places come one by one and end one by one, so the arrays that are asked for follow instead of being made anew."""

    def __init__(self) -> None:
        self._told: List[_Told] = []
        # Of the first of these, as many as there were when they were last asked for.
        self._places = np.empty((0, 2))
        self._robots: List[str] = []

    def add(self, x: float, y: float, until: float, robot: str) -> None:
        """A place in metres in the own frame that a robot has explored, believed until a time in seconds."""
        self._told.append(_Told(x, y, until, robot))
        if len(self._told) > MAXIMUM_TOLD:
            del self._told[0]
            self._places, self._robots = self._places[1:], self._robots[1:]

    def expired(self, now: float) -> bool:
        """True if there are some that are no longer believed; `at` forgets them."""
        # The first that were told end first.
        return bool(self._told) and self._told[0].until <= now

    def at(self, now: float) -> Tuple[np.ndarray, List[str]]:
        """(n, 2) array in metres of the places that are believed now, oldest first, and by whom. Not to be changed."""
        if self.expired(now):
            stays = [told.until > now for told in self._told]
            known = len(self._robots)
            self._told = [told for told, there in zip(self._told, stays) if there]
            self._places = self._places[np.array(stays[:known], dtype=bool)]
            self._robots = [robot for robot, there in zip(self._robots, stays) if there]
        new = self._told[len(self._robots) :]
        if new:
            self._places = np.concatenate([self._places, [(told.x, told.y) for told in new]])
            self._robots = self._robots + [told.robot for told in new]
        return self._places, self._robots
