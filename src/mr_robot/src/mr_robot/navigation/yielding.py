"""Who gives way when robots stand in one another's way, and where to.

In a doorway two robots cannot pass; one has to go back and aside. If the other robot is known by name and position
the one whose name sorts later goes; otherwise, and when the other does not move, chance decides, so the two never
keep step.
"""

import math
from typing import Mapping, Optional, Tuple

import numpy as np

from mr_grid import Pose
from mr_robot import _navigation
from mr_robot.navigation.options import LONGEST_DETOUR, PROGRESS
from mr_robot.navigation.planner import CostMap, Plan, plan

Point = Tuple[float, float]

REACH = 1.4  # m within which something that the map does not know counts as in the way
SPREAD, LARGEST_SPREAD = 3.0, 12.0  # times the patience
AGAIN = 30.0  # s within which giving way once more shows that it was in vain
WINNER_PATIENCE = 6.0  # s a robot with the right of way waits before it gives way nevertheless
ROOM = 0.12  # m more than a robot has to keep from walls, at a place to wait
SLOWEST = 2.0  # times a free cell's cost; what narrow places cost on other ways would end the search in them


class HeldUp:
    """Decides when a robot that something holds up has to give way."""

    def __init__(self, name: str, patience: float, random: np.random.Generator, robot_radius: float) -> None:
        """`patience`: s. `robot_radius`: of the largest robot of the team, m."""
        self._name = name
        self._robot_size = round(2.0 * robot_radius + 0.12, 3)  # m around a reported position in which its hits lie
        self._patience = patience
        self._random = random
        self._since: Optional[float] = None
        self._limit = 0.0
        self._closest = math.inf  # m, how near the blocker has been meanwhile
        self._spread = SPREAD  # times the patience, by chance
        self._gave_way_at = -math.inf

    def clear(self) -> None:
        self._since = None

    def gave_way(self, now: float) -> None:
        """Once per time. When it was in vain, as the other one did so, too, chance decides about more next time."""
        self._spread = min(2.0 * self._spread, LARGEST_SPREAD) if now - self._gave_way_at < AGAIN else SPREAD
        self._gave_way_at = now

    def must_give_way(self, now: float, place: Point, blocker: Optional[Point], others: Mapping[str, Point]) -> bool:
        """Once per step. `place`: of the robot; `blocker` is None while nothing holds it up. `others`: reported
        positions."""
        if blocker is None:
            self._since = None
            return False
        off = math.dist(place, blocker)
        if self._since is None or now < self._since or off > self._closest + PROGRESS:
            self._since, self._closest = now, off
            self._limit = self._draw(blocker, others)
        self._closest = min(self._closest, off)
        return now - self._since >= self._limit

    def _draw(self, blocker: Point, others: Mapping[str, Point]) -> float:
        near = [name for name, position in others.items() if math.dist(position, blocker) < self._robot_size]
        chance = self._random.random()
        if not near:
            return self._patience * (0.5 + self._spread * chance)
        if self._name > min(near):
            return 0.3 * self._patience
        return WINNER_PATIENCE + 2.0 * chance


def nearest_blocker(points: np.ndarray, pose: Pose) -> Optional[Point]:
    """The nearest of the points (n, 2) within REACH and not behind the robot."""
    if not len(points):
        return None
    offset = points - pose[:2]
    distance = np.hypot(offset[:, 0], offset[:, 1])
    ahead = offset[:, 0] * math.cos(pose[2]) + offset[:, 1] * math.sin(pose[2]) > -0.2
    distance = np.where(ahead, distance, np.inf)
    index = int(np.argmin(distance))
    return (float(points[index, 0]), float(points[index, 1])) if distance[index] < REACH else None


def find_retreat(costs: CostMap, obstacles: np.ndarray, pose: Pose, blocker: Point) -> Optional[Plan]:
    """A way to the nearest place beside the way of what comes from `blocker`, or else far back along it."""
    grid = costs.grid
    start = grid.info.cell_of(pose[0], pose[1])
    if not grid.info.contains(*start):
        return None
    slowness = costs.slowness(obstacles, pose, narrow=True)
    slowness = np.where(np.isfinite(slowness), np.minimum(slowness, SLOWEST), slowness)
    slowness[start] = min(slowness[start], SLOWEST)
    limit = 3.0 * LONGEST_DETOUR / grid.resolution
    cost = _navigation.march(slowness, [(start[0], start[1], 0.0)], limit=limit)
    rows, columns = np.nonzero(
        np.isfinite(cost) & (costs.wall_distance > round(costs.options.inscribed_radius + ROOM, 3))
    )
    if not rows.size:
        return None
    x = grid.origin[0] + (columns + 0.5) * grid.resolution - blocker[0]
    y = grid.origin[1] + (rows + 0.5) * grid.resolution - blocker[1]
    length = max(math.dist(pose[:2], blocker), 1e-6)
    ux, uy = (pose[0] - blocker[0]) / length, (pose[1] - blocker[1]) / length
    aside, along, away = np.abs(ux * y - uy * x), ux * x + uy * y, np.hypot(x, y)
    way = cost[rows, columns] * grid.resolution
    passing = costs.options.passing_distance  # beside the other's way, where it can pass
    # Waiting on the other's way helps only when it is far away: each metre nearer than wanted costs.
    price = way + 20.0 * np.maximum(0.0, passing - aside) + 4.0 * np.maximum(0.0, 1.2 - away)
    price += np.where(aside < passing, 3.0 * np.maximum(0.0, LONGEST_DETOUR - along), 0.0)
    best = int(np.argmin(price))
    target = grid.info.centre_of(int(rows[best]), int(columns[best]))
    return plan(costs, obstacles, pose, target, 0.3, narrow=True)
