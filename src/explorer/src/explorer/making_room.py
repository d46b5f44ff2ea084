"""A robot that is at home stands in the way of others who live behind it: it drives aside until they are in."""

import math
from typing import Dict, List, Optional, Tuple

import numpy as np

from explorer.foreign import Element, ForeignFrontiers
from explorer.geometry import Position, distance
from explorer.perception import Perception
from explorer.senses import Senses
from explorer.team import Team
from mr_grid import Pose

PERIOD = 1.0  # s between two looks at the others
STILL = 0.5  # m within which a robot that tries again and again stays
HELD = 8.0  # s for which it does
AT_HOME = 0.8  # m from its home, within which a robot needs no room
NEAR = 2.5  # m, a robot that stands farther away is held by somebody else
CLEARANCE = 0.2  # m between robots that pass
REACH = 5.0  # m that a robot drives aside
TRIED = 50  # places aside, the nearest first
PATIENCE = 40.0  # s for one robot at a time
TIMES = 3  # for any robot


class MakingRoom:
    """`robot`: for whom, None while there is nobody. A robot's home is the origin of its map."""

    def __init__(
        self, senses: Senses, perception: Perception, team: Team, foreign: ForeignFrontiers, radius: float
    ) -> None:
        """`radius`: m, of the largest robot of the team."""
        self.robot: Optional[str] = None
        self._senses, self._perception, self._team, self._foreign = senses, perception, team, foreign
        self._passing = 2.0 * radius + CLEARANCE
        self._place: Optional[Pose] = None
        self._until = self._looked_at = -math.inf
        self._stands: Dict[str, Tuple[Position, float]] = {}  # where each of the others does, and since when, s
        self._times: Dict[str, int] = {}

    def place(self, now: float) -> Optional[Pose]:
        """Where to drive and wait, map frame; None while nobody needs room."""
        if not 0.0 <= now - self._looked_at < PERIOD:
            self._looked_at = now
            positions = self._team.positions(now)
            self._watch(positions, now)
            if self.robot is not None and (now > self._until or not self._is_out(self.robot, positions)):
                self.robot = self._place = None
            if self.robot is None:
                self._look_for(positions, now)
        return self._place

    def _watch(self, positions: Dict[str, Position], now: float) -> None:
        for name, position in positions.items():
            place, _ = self._stands.get(name, ((math.inf, math.inf), now))
            if distance(place, position) > STILL:
                self._stands[name] = (position, now)

    def _home_of(self, robot: str) -> Optional[Position]:
        return self._foreign.to_own_frame(Element(robot, 0, 0.0, 0.0))

    def _is_out(self, robot: str, positions: Dict[str, Position]) -> bool:
        home = self._home_of(robot)
        return home is not None and robot in positions and distance(positions[robot], home) > AT_HOME

    def _look_for(self, positions: Dict[str, Position], now: float) -> None:
        here, ways = self._senses.pose, self._perception.ways
        if here is None or ways is None:
            return
        for name, position in sorted(positions.items()):
            held = now - self._stands[name][1] >= HELD and distance(position, (here.x, here.y)) < NEAR
            home = self._home_of(name)
            if not held or home is None or self._times.get(name, 0) >= TIMES or not self._is_out(name, positions):
                continue
            way = np.array(ways.grid.field_from(*position).path_to(*home)).reshape(-1, 2)
            if len(way) == 0 or _nearest(way, here.x, here.y) >= self._passing:
                continue
            place = self._aside(np.vstack([way, [home]]), here, positions)
            if place is not None:
                self.robot, self._place, self._until = name, place, now + PATIENCE
                self._times[name] = self._times.get(name, 0) + 1
                return

    def _aside(self, way: np.ndarray, here: Pose, positions: Dict[str, Position]) -> Optional[Pose]:
        """The place soonest reached that is beside the way and beside all robots; none where there is no such."""
        assert self._perception.ways is not None
        grid = self._perception.ways.grid
        field = grid.field_from(here.x, here.y)
        cells = np.argwhere(field.cost < REACH)
        places = np.array(grid.info.centres_of(cells)).reshape(-1, 2)
        avoided = np.vstack([way, *([place] for place in positions.values())])
        beside = np.hypot(*(places[:, None] - avoided[None]).transpose(2, 0, 1)).min(1) >= self._passing
        order = np.argsort(field.cost[tuple(cells.T)], kind="stable")
        for x, y in places[order[beside[order]]][:TRIED].tolist():
            if not self._is_blocked(field.path_to(x, y), here, positions):
                return Pose(x, y, here.yaw)
        return None

    def _is_blocked(self, path: List[Position], here: Pose, positions: Dict[str, Position]) -> bool:
        """Whether it leads nearer to another robot than this one is."""
        points = np.array(path).reshape(-1, 2)
        for x, y in positions.values():
            least = min(distance((here.x, here.y), (x, y)), self._passing) - CLEARANCE
            if len(points) and _nearest(points, x, y) < least:
                return True
        return False


def _nearest(way: np.ndarray, x: float, y: float) -> float:
    """m from a point to those (n, 2) of a way."""
    return float(np.hypot(way[:, 0] - x, way[:, 1] - y).min())
