"""A robot with a perfect local map and perfect control, for questions about strategy alone."""

from __future__ import annotations

import math
from typing import Mapping

import cv2
import numpy as np

from mr_experiments.body import GoalEnd
from mr_experiments.stopwatch import Stopwatch
from mr_sim import _world
from mr_sim.navigation.options import Grid, NavigationOptions
from mr_sim.navigation.planner import CostMap, Plan, path, plan, without_robots
from mr_sim.pose import Pose, compose, placed, seen_from
from mr_sim.raster import Grid as Raster
from mr_sim.slam.engine import MAP_UPDATE_INTERVAL, OccupancyMap
from mr_sim.world_model import RangerDescription

RESOLUTION = 0.05  # m, of the map
BEAMS = 181  # that bound the visible area
BEHIND = 0.08  # m behind where a beam ends that are seen, which is the wall itself
LOOK_AHEAD = 0.35  # m of the path that the robot aims at
STRAIGHT = 0.6  # rad off its way up to which a robot drives while it turns
SEARCH_RADIUS = 0.3  # m around a goal in which a free place will do
YAW_TOLERANCE = 0.1  # rad


class FastBody:
    """Moves along planned paths at full speed; knows what it has seen exactly. Robots do not touch each other."""

    def __init__(self, start: Pose, ranger: RangerDescription, walls: Raster, stopwatch: Stopwatch) -> None:
        """`start`: world frame; `walls`: the true ones."""
        self.options = NavigationOptions()
        self.pose: Pose = (0.0, 0.0, 0.0)  # map frame
        self.velocity = (0.0, 0.0)  # m/s, rad/s
        self.on_goal_end: GoalEnd = lambda *_: None
        self._start, self._ranger, self._stopwatch = start, ranger, stopwatch
        self._raster = _world.Raster(walls.cells, walls.resolution, walls.origin)
        self._true_cells, self._origin = _in_map_frame(walls, start)
        self._seen = np.zeros(self._true_cells.shape, dtype=np.uint8)
        self._map_at = -math.inf
        self._costs: CostMap | None = None
        self._others: Mapping[str, tuple[float, float]] = {}
        self._goal: tuple[int, Pose] | None = None
        self._path: list[tuple[float, float]] = []
        self._way: Plan | None = None

    @property
    def true_pose(self) -> Pose:
        """World frame."""
        return compose(self._start, self.pose)

    def look(self) -> None:
        """Adds the area visible from here to the map."""
        with self._stopwatch.span("visibility"):
            ranger = self._ranger
            eye = compose(self.true_pose, ranger.mount)
            angles = eye[2] + np.linspace(-0.5, 0.5, BEAMS) * ranger.field_of_view
            ranges = self._raster.cast(eye[:2], angles, ranger.range_max)
            reach = np.where(ranges < ranger.range_max - 1e-3, ranges + BEHIND, ranges)[:, None]
            ends = np.asarray(eye[:2]) + reach * np.stack([np.cos(angles), np.sin(angles)], axis=1)
            corners = np.concatenate([[eye[:2]], ends])
            cells = (seen_from(corners, self._start) - self._origin) / RESOLUTION
            cv2.fillPoly(self._seen, [np.floor(cells).astype(np.int32)], 1)

    def new_map(self, now: float) -> OccupancyMap | None:
        """The local map if it is time to hand one out."""
        if now - self._map_at < MAP_UPDATE_INTERVAL - 1e-6:
            return None
        self._map_at = now
        rows, columns = np.flatnonzero(self._seen.any(axis=1)), np.flatnonzero(self._seen.any(axis=0))
        window = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        cells = np.where(self._seen[window] > 0, self._true_cells[window], np.int8(-1))
        origin = (self._origin[0] + columns[0] * RESOLUTION, self._origin[1] + rows[0] * RESOLUTION)
        return OccupancyMap(cells, RESOLUTION, origin)

    def drive(self, seconds: float) -> None:
        """Moves on."""
        x, y, yaw = self.pose
        self.velocity = (0.0, 0.0)
        if self._goal is None:
            return
        while len(self._path) > 1 and math.dist(self._path[0], (x, y)) < LOOK_AHEAD:
            self._path.pop(0)
        at_end = len(self._path) <= 1 and (not self._path or math.dist(self._path[0], (x, y)) < 0.05)
        ahead = self._goal[1][2] if at_end else math.atan2(self._path[0][1] - y, self._path[0][0] - x)
        error = math.remainder(ahead - yaw, 2.0 * math.pi)
        if at_end and abs(error) < YAW_TOLERANCE:
            self._end(True, "goal reached")
            return
        turn = max(-1.0, min(1.0, error / (self.options.max_angular_velocity * seconds)))
        turn *= self.options.max_angular_velocity
        speed = 0.0
        if not at_end and abs(error) < STRAIGHT:
            left = math.dist(self._path[0], (x, y)) if len(self._path) == 1 else math.inf
            speed = min(self.options.max_linear_velocity, left / seconds)
        yaw += turn * seconds
        self.pose = (x + speed * seconds * math.cos(yaw), y + speed * seconds * math.sin(yaw), yaw)
        self.velocity = (speed, turn)

    def set_map(self, cells: np.ndarray, resolution: float, origin: tuple[float, float]) -> None:
        with self._stopwatch.span("navigation"):
            grid = without_robots(Grid(cells, resolution, origin), list(self._others.values()))
            self._costs = CostMap(grid, self.options, self._costs)
            self._plan()

    def set_others(self, positions: Mapping[str, tuple[float, float]], now: float) -> None:
        self._others = positions

    def set_goal(self, goal_id: int, pose: Pose, now: float) -> None:
        self._goal = (goal_id, pose)
        with self._stopwatch.span("navigation"):
            self._plan()

    def cancel(self) -> None:
        self._goal, self._path = None, []

    def _plan(self) -> None:
        if self._goal is None or self._costs is None:
            return
        self._way = plan(self._costs, np.empty((0, 2)), self.pose, self._goal[1][:2], SEARCH_RADIUS, self._way)
        if self._way is None:
            self._end(False, "there is no way")
            return
        self._path = path(self._way, self.pose)[1:]

    def _end(self, reached: bool, text: str) -> None:
        assert self._goal is not None
        goal_id = self._goal[0]
        self.cancel()
        self.on_goal_end(goal_id, reached, text)


def _in_map_frame(walls: Raster, start: Pose) -> tuple[np.ndarray, np.ndarray]:
    """The true map on the lattice of a robot's map: int8 cells, 0 free, 100 occupied, and the lower left corner, m."""
    rows, columns = walls.cells.shape
    size = np.array([columns, rows]) * walls.resolution
    corners = np.array([[0.0, 0.0], [size[0], 0.0], [size[0], size[1]], [0.0, size[1]]]) + walls.origin
    local = seen_from(corners, start)
    low = np.floor(local.min(axis=0) / RESOLUTION) - 1
    high = np.ceil(local.max(axis=0) / RESOLUTION) + 1
    width, height = (high - low).astype(int)
    origin = low * RESOLUTION
    grid = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).reshape(-1, 2)
    centres = placed((grid + 0.5) * RESOLUTION + origin, start)
    index = np.floor((centres - walls.origin) / walls.resolution).astype(np.int64)
    inside = ((index >= 0) & (index < (columns, rows))).all(axis=1)
    cells = np.zeros(len(centres), dtype=np.int8)
    cells[inside] = np.where(walls.cells[index[inside, 1], index[inside, 0]] > 0, 100, 0)
    return cells.reshape(height, width), origin
