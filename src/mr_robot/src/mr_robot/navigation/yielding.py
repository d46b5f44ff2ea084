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
from mr_robot.navigation.nearing import Nearing
from mr_robot.navigation.options import AT_REST, LONGEST_DETOUR, PROGRESS, REACH, STANDING, NavigationOptions
from mr_robot.navigation.planner import CostMap, Plan, plan

Point = Tuple[float, float]

SPREAD = 3.0  # times the patience, by chance; up to four times as much when it was in vain
SLOWEST = 2.0  # times a free cell's cost; what narrow places cost on other ways would end the search in them


class HeldUp:
    """Decides when a robot that something holds up has to give way."""

    def __init__(self, name: str, options: NavigationOptions, random: np.random.Generator) -> None:
        self._name = name
        self._robot_size = 2.0 * options.largest_robot_radius + PROGRESS  # m around a position in which its hits lie
        self._patience, self._again = options.yield_patience, options.blocked_timeout
        self._soon = 0.5 * self._patience
        self._random = random
        self._since: Optional[float] = None
        self._limit = 0.0
        self._closest = math.inf  # m, how near the blocker has been meanwhile
        self._spread = SPREAD  # times the patience, by chance
        self._gave_way_at = -math.inf
        self._goes_by_name = False  # whether it is for this robot to go, by its name

    def clear(self) -> None:
        self._since = None

    def gave_way(self, now: float) -> None:
        """Once per time. When it was in vain, as the other one did so, too, chance decides about more next time."""
        self._spread = min(2.0 * self._spread, 4.0 * SPREAD) if now - self._gave_way_at < self._again else SPREAD
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
            self._limit = self._limit_for(blocker, others)
        self._closest = min(self._closest, off)
        return now - self._since >= self._limit

    def _limit_for(self, blocker: Point, others: Mapping[str, Point]) -> float:
        near = [name for name, position in others.items() if math.dist(position, blocker) < self._robot_size]
        self._goes_by_name = bool(near) and self._name > min(near)
        if not near:
            return self._draw()
        return self._soon if self._goes_by_name else AT_REST + self._random.random() * self._patience

    def pause(self) -> float:
        """s to wait beside the other's way; who goes by name is seen off after that, and no chance is needed."""
        return self._soon if self._goes_by_name else self._draw()

    def _draw(self) -> float:
        """s to wait, by chance, so that two robots never keep step."""
        return self._soon + self._patience * self._spread * self._random.random()


class Retreat:
    """A way out of another robot's way, as long as the robot gets on along it: the other may stand in that, too."""

    def __init__(self, way: Plan, now: float) -> None:
        self.way = way
        self._nearing = Nearing(now)

    def advance(self, now: float, pose: Pose, gained_room: bool) -> None:
        """Once per step. `gained_room`: whether a manoeuvre has just ended."""
        self._nearing.see(self.way.cost_at(pose[0], pose[1]), now)
        if gained_room:
            self._nearing.at = now

    def leads_on(self, now: float) -> bool:
        return now - self._nearing.at < 2.0 * STANDING  # manoeuvres lead away first


def nearest_blocker(points: np.ndarray, pose: Pose) -> Optional[Point]:
    """The nearest of the points (n, 2) within REACH and not behind the robot."""
    if not len(points):
        return None
    offset = points - pose[:2]
    distance = np.hypot(offset[:, 0], offset[:, 1])
    ahead = offset[:, 0] * math.cos(pose[2]) + offset[:, 1] * math.sin(pose[2]) > 0.0
    distance = np.where(ahead, distance, np.inf)
    index = int(np.argmin(distance))
    return (float(points[index, 0]), float(points[index, 1])) if distance[index] < REACH else None


def find_retreat(costs: CostMap, obstacles: np.ndarray, pose: Pose, blocker: Point) -> Optional[Plan]:
    """A way to the nearest place beside the way of what comes from `blocker`, or else far back along it."""
    grid, options = costs.grid, costs.options
    start = grid.info.cell_of(pose[0], pose[1])
    if not grid.info.contains(*start):
        return None
    slowness = costs.slowness(obstacles, pose, narrow=True)
    slowness = np.where(np.isfinite(slowness), np.minimum(slowness, SLOWEST), slowness)
    slowness[start] = min(slowness[start], SLOWEST)
    limit = SLOWEST * LONGEST_DETOUR / grid.resolution
    cost = _navigation.march(slowness, [(start[0], start[1], 0.0)], limit=limit)
    rows, columns = np.nonzero(
        np.isfinite(cost) & (costs.wall_distance > round(options.inscribed_radius + options.moving_margin, 3))
    )
    if not rows.size:
        return None
    x = grid.origin[0] + (columns + 0.5) * grid.resolution - blocker[0]
    y = grid.origin[1] + (rows + 0.5) * grid.resolution - blocker[1]
    length = max(math.dist(pose[:2], blocker), 1e-6)
    ux, uy = (pose[0] - blocker[0]) / length, (pose[1] - blocker[1]) / length
    aside, along = np.abs(ux * y - uy * x), ux * x + uy * y
    way = cost[rows, columns] * grid.resolution
    passing = options.passing_distance  # beside the other's way, where it can pass
    # Waiting on the other's way helps only far back along it.
    short = np.maximum(0.0, passing - aside) + np.maximum(0.0, LONGEST_DETOUR - along)
    price = way + np.where(aside < passing, short, 0.0)
    best = int(np.argmin(price))
    target = grid.info.centre_of(int(rows[best]), int(columns[best]))
    return plan(costs, obstacles, pose, target, options.goal_search_radius, narrow=True)
