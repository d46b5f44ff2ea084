"""The way to the goal: planned through the map, around what moves there, and given up when it leads nowhere."""

import math
from dataclasses import dataclass, field
from typing import Optional, Tuple

import numpy as np

from mr_grid import Pose
from mr_robot.navigation.command import GivenUp
from mr_robot.navigation.nearing import Nearing
from mr_robot.navigation.options import AT_REST, CREEPING, LONGEST_DETOUR, PROGRESS, REACH, NavigationOptions
from mr_robot.navigation.planner import CostMap, Plan, from_here, plan


@dataclass
class _Goal:
    pose: Pose
    since: float
    best: float = math.inf  # least way left so far by the present plan, m
    deadline: float = math.inf
    through_map: Nearing = field(default_factory=Nearing)  # by the map alone
    blocked_since: Optional[float] = None
    goes_around: bool = False  # what blocks the way is at rest
    failed: bool = False  # whether the latest plan did


class Route:
    def __init__(self, options: NavigationOptions) -> None:
        self.plan: Optional[Plan] = None
        self.progress_at = 0.0  # s, when the robot last got on, or found another way to do so
        self.nearer_at = 0.0  # s, when it last came nearer to its goal than before
        self._options = options
        self._goal: Optional[_Goal] = None
        self._known: Optional[Plan] = None  # the latest way through the map alone
        self._planned_at = -math.inf

    # --- the goal -----------------------------------------------------------------------------------------------------

    @property
    def has_goal(self) -> bool:
        return self._goal is not None

    @property
    def goal(self) -> Pose:
        assert self._goal is not None
        return self._goal.pose

    @property
    def since(self) -> float:
        """s, when the goal was set."""
        assert self._goal is not None
        return self._goal.since

    @property
    def closed(self) -> bool:
        """Whether the way closed after it was planned."""
        return self._goal is not None and self._goal.blocked_since is not None

    def set_goal(self, goal: Pose, now: float) -> None:
        if self._goal is None:
            self.progress_at = now  # another goal is none
        self._goal = _Goal(goal, now)
        self._planned_at = -math.inf
        self.plan = None

    def clear(self) -> None:
        self._goal = None
        self.plan = None

    def resume(self, now: float, left_alone_since: Optional[float]) -> None:
        """After giving way since then."""
        assert self._goal is not None
        self.progress_at = now
        self._goal.best = math.inf
        self._planned_at = -math.inf
        if left_alone_since is not None and self._goal.blocked_since is not None:
            self._goal.blocked_since += now - left_alone_since  # what it left alone did not block it

    def advance(self, now: float, pose: Pose) -> float:
        """The way left, m. Raises GivenUp when the goal has taken too long."""
        assert self._goal is not None and self.plan is not None
        goal, left = self._goal, self.plan.cost_at(pose[0], pose[1])
        if left < goal.best - PROGRESS:
            if goal.best < math.inf:
                self.progress_at = now
            goal.best, self.nearer_at = left, now
        if now > goal.deadline:
            raise GivenUp(f"{now - goal.since:.0f} s were not enough to reach the goal, {left:.1f} m are left")
        return left

    # --- the plan -----------------------------------------------------------------------------------------------------

    def update(self, now: float, pose: Pose, costs: CostMap, moving: np.ndarray) -> None:
        """Plans when it is time. `moving`: points (n, 2) of what moves. Raises GivenUp when there is no way."""
        assert self._goal is not None
        goal, options = self._goal, self._options
        if 0.0 <= now - self._planned_at < options.plan_period:
            return
        self._planned_at = now
        target, radius = (goal.pose[0], goal.pose[1]), options.goal_search_radius
        empty, narrow = np.empty((0, 2)), False
        known = plan(costs, empty, pose, target, radius, self._known)
        if known is None:
            narrow = True
            known = plan(costs, empty, pose, target, radius, self._known, narrow)
        self._known = known
        if known is None:
            self._without_way(now, pose, costs)
            return
        goal.failed = False
        around = plan(costs, moving, pose, target, radius, known, narrow) if len(moving) else known
        way = self._prefer(now, pose, known, around)
        left = way.cost_at(pose[0], pose[1])
        if self.plan is None or left > goal.best + REACH:
            goal.best = left + PROGRESS
        if goal.deadline == math.inf:
            self._allow(left, now)
        self.plan = way

    def _allow(self, left: float, now: float) -> None:
        """Time for a way of `left` m, if the robot only just gets on, and to be blocked once."""
        assert self._goal is not None
        self._goal.deadline = now + self._options.blocked_timeout + left / CREEPING

    def _prefer(self, now: float, pose: Pose, known: Plan, around: Optional[Plan]) -> Plan:
        """Around what moves when that is not far; else up to it, waiting. Raises GivenUp when it has not moved for
        long."""
        assert self._goal is not None
        goal = self._goal
        left = known.cost_at(pose[0], pose[1])
        goal.through_map.see(left, now)
        if around is not None and around.cost_at(pose[0], pose[1]) - left <= LONGEST_DETOUR:
            goal.blocked_since, goal.goes_around = None, False
            return around
        if goal.blocked_since is None:
            goal.blocked_since = now
        if around is not None and goal.goes_around:
            return around
        timeout = self._options.blocked_timeout
        # Who gives way and comes back comes nearer each time, but not nearer than before.
        goal.blocked_since = max(goal.blocked_since, min(self.nearer_at, goal.through_map.at + timeout))
        waited = now - goal.blocked_since
        if around is not None and waited > AT_REST:
            goal.goes_around, self.nearer_at = True, now
            self._allow(around.cost_at(pose[0], pose[1]), now)
            return around
        if waited <= timeout:
            return known
        raise GivenUp(
            f"the way to ({goal.pose[0]:.2f}, {goal.pose[1]:.2f}) has been blocked for {waited:.0f} s by an obstacle "
            "that is not in the map"
        )

    def _without_way(self, now: float, pose: Pose, costs: CostMap) -> None:
        assert self._goal is not None
        goal = self._goal
        if self.plan is not None:
            # There was a way: what closed it came later and may go again. The old plan leads up to where that shows.
            self.plan = from_here(self.plan, pose)
            if goal.blocked_since is None:
                goal.blocked_since = now
            goal.blocked_since = max(goal.blocked_since, self.nearer_at)
            if now - goal.blocked_since <= self._options.blocked_timeout:
                return
        if goal.failed:
            x, y, _ = goal.pose
            raise GivenUp(f"no way to ({x:.2f}, {y:.2f}): {self._why_no_way((x, y), costs)}")
        goal.failed = True

    def _why_no_way(self, target: Tuple[float, float], costs: CostMap) -> str:
        grid = costs.grid
        row, column = grid.info.cell_of(*target)
        if not grid.info.contains(row, column):
            return "the goal lies outside the map"
        value = int(grid.cells[row, column])
        if 0 <= value <= 50:
            return "walls or unknown cells close it off"
        where = "in the unknown" if value < 0 else "in a wall"
        return f"the goal is {where} and nothing within {self._options.goal_search_radius:g} m of it can be reached"
