"""A robot with a perfect local map and perfect control, for questions about strategy alone."""

from __future__ import annotations

import math
from typing import Mapping

import numpy as np

from mr_experiments.common.stopwatch import Stopwatch
from mr_experiments.host.fast.team_sight import TeamSight
from mr_experiments.host.fast.wheels import Wheels
from mr_grid import OccupancyGrid, Pose
from mr_measures.true_map import TrueMap
from mr_robot.navigation.look_around import RATE
from mr_robot.navigation.options import NavigationOptions
from mr_robot.navigation.planner import CostMap, Plan, path, plan
from mr_robot.platforms.parameters import NARROW_VIEW
from mr_robot.slam.engine import MAP_UPDATE_INTERVAL
from mr_sim import _world
from mr_sim.body import GoalEnd
from mr_sim.raster import Grid as Raster
from mr_sim.true_world import occupancy_of
from mr_sim.world_description import RangerDescription

BEAMS = 181  # that bound the visible area
BEHIND = 0.08  # m behind where a beam ends that are seen, which is the wall itself
LOOK_AHEAD = 0.35  # m of the path that the robot aims at


class FastBody:
    """Moves along planned paths as its drive lets it, and knows what it has seen exactly. Robots touch no other."""

    def __init__(
        self, name: str, start: Pose, ranger: RangerDescription, navigation: NavigationOptions, walls: Raster,
        sight: TeamSight, stopwatch: Stopwatch,
    ) -> None:  # fmt: skip
        """`start`: world frame; `walls`: the true ones."""
        self.options = navigation
        self.pose = Pose()  # map frame
        self._wheels = Wheels(navigation)
        # rad still to turn before the first goal; see navigation's LookAround.
        self._look_around = 2.0 * math.pi if navigation.look_around and ranger.field_of_view < NARROW_VIEW else 0.0
        self.on_goal_end: GoalEnd = lambda *_: None
        self._name, self._start, self._ranger, self._sight, self._stopwatch = name, start, ranger, sight, stopwatch
        self._bearings = np.linspace(-0.5, 0.5, BEAMS) * ranger.field_of_view  # rad, of the beams
        self._raster = _world.Raster(walls.cells, walls.resolution, walls.origin)
        self.true_map = TrueMap(occupancy_of(walls), start)
        self._seen = self.true_map.nothing()
        self._looked_from: Pose | None = None
        self._map_at = -math.inf
        self._costs: CostMap | None = None
        self._goal: tuple[int, Pose] | None = None
        self._path: list[tuple[float, float]] = []
        self._way: Plan | None = None

    @property
    def true_pose(self) -> Pose:
        """World frame."""
        return self._start.compose(self.pose)

    @property
    def velocity(self) -> tuple[float, float]:
        """m/s, rad/s."""
        return self._wheels.velocity

    def look(self) -> None:
        """Adds the area visible from here to the map."""
        if self.pose == self._looked_from:
            return
        self._looked_from = self.pose
        with self._stopwatch.span("visibility"):
            ranger = self._ranger
            eye = self.true_pose.compose(ranger.mount)
            angles = eye[2] + self._bearings
            ranges = self._raster.cast(eye[:2], angles, ranger.range_max)
            reach = np.where(ranges < ranger.range_max - 1e-3, ranges + BEHIND, ranges)[:, None]
            ends = np.asarray(eye[:2]) + reach * np.stack([np.cos(angles), np.sin(angles)], axis=1)
            area = np.concatenate([[eye[:2]], ends])
            self.true_map.add(area, self._seen)
            self._sight.add(self._name, area, self.true_pose)

    def new_map(self, now: float) -> OccupancyGrid | None:
        """The local map if it is time to hand one out."""
        if now - self._map_at < MAP_UPDATE_INTERVAL - 1e-6:
            return None
        self._map_at = now
        return self.true_map.known(self._seen)

    def drive(self, seconds: float) -> None:
        """Moves on."""
        if self._goal is None:
            self._wheels.brake(seconds)
        elif self._look_around > 0.0:
            self._turn_around(seconds)
        else:
            self._follow(self._goal[1], seconds)
        (speed, turn), (x, y, yaw) = self.velocity, self.pose
        if speed or turn:
            middle = yaw + 0.5 * turn * seconds
            way = speed * seconds
            self.pose = Pose(x + way * math.cos(middle), y + way * math.sin(middle), yaw + turn * seconds)

    def _turn_around(self, seconds: float) -> None:
        """Before the first goal, whether or not there is a way yet."""
        self._wheels.turn(self._look_around, seconds, RATE)
        self._look_around -= self.velocity[1] * seconds
        if self._look_around <= 0.0:
            self._plan()

    def _follow(self, goal: Pose, seconds: float) -> None:
        """Sets the velocity of a robot on its way; ends the goal where it is reached."""
        x, y, yaw = self.pose
        while len(self._path) > 1 and math.dist(self._path[0], (x, y)) < LOOK_AHEAD:
            self._path.pop(0)
        end = self._path[-1] if self._path else (x, y)
        if math.dist(end, (x, y)) >= self.options.xy_goal_tolerance:
            ahead = math.atan2(self._path[0][1] - y, self._path[0][0] - x)
            self._wheels.towards(math.remainder(ahead - yaw, 2.0 * math.pi), seconds)
            return
        off = math.remainder(goal[2] - yaw, 2.0 * math.pi)
        if abs(off) <= self.options.yaw_goal_tolerance:
            self._wheels.brake(seconds)
            self._end(True, "goal reached")
        else:
            self._wheels.turn(off, seconds)

    def set_map(self, grid: OccupancyGrid) -> None:
        with self._stopwatch.span("navigation"):
            self._costs = CostMap(grid, self.options, self._costs)
            self._plan()

    def set_others(self, positions: Mapping[str, tuple[float, float]], now: float) -> None:
        """They are in nobody's way."""

    def set_goal(self, goal_id: int, pose: Pose, now: float) -> None:
        self._goal = (goal_id, pose)
        with self._stopwatch.span("navigation"):
            self._plan()

    def cancel(self) -> None:
        self._goal, self._path = None, []

    def _plan(self) -> None:
        if self._goal is None or self._costs is None:
            return
        goal, radius = self._goal[1][:2], self.options.goal_search_radius
        self._way = plan(self._costs, np.empty((0, 2)), self.pose, goal, radius, self._way)
        if self._way is None and self._look_around > 0.0:
            return
        if self._way is None:
            self._end(False, "there is no way")
            return
        self._path = path(self._way, self.pose)[1:]

    def _end(self, reached: bool, text: str) -> None:
        assert self._goal is not None
        goal_id = self._goal[0]
        self.cancel()
        self.on_goal_end(goal_id, reached, text)
