"""Ways through a map: costs near walls, cost to go to a goal by fast marching, paths down that cost."""

import math
from dataclasses import dataclass
from typing import List, Optional, Tuple

import cv2
import numpy as np

from mr_sim import _navigation
from mr_sim.navigation.options import Grid, NavigationOptions
from mr_sim.pose import Pose

NEAR_WALL_COST = 6.0  # a cell at the wall costs this much more than a free one
ESCAPE_RADIUS = 0.45  # m around a robot that stands too near to a wall in which it may move out
ESCAPE_COST = 25.0
FIELD_MARGIN = 2.0  # m of cost to go beyond the robot that local control can use
PATH_STEPS = 20000
ROBOT_REACH = 0.45  # m from a robot's reported position to the middle of what the laser saw of it
ROBOT_EXTENT = 0.8  # m; obstacles larger than this, with all that touches them, are walls, however near a robot is


@dataclass(frozen=True)
class Plan:
    """`cost`: float32 (rows, columns), cells of way still to go, infinity = not computed or no way."""

    grid: Grid
    cost: np.ndarray
    goal: Tuple[float, float]  # the point led to: the goal asked for, or one near it that can be reached
    exact: bool  # whether it is the goal asked for

    def cost_at(self, x: float, y: float) -> float:
        """Metres of free way from (x, y), infinity where there is none."""
        row, column = self.grid.cell(x, y)
        if not self.grid.contains(row, column):
            return math.inf
        return float(self.cost[row, column]) * self.grid.resolution


class CostMap:
    """Distances to walls of one map, and slowness for planning over it."""

    def __init__(self, grid: Grid, options: NavigationOptions) -> None:
        self.grid = grid
        self._options = options
        self.wall_distance = distance_to(grid.cells > 50, grid.resolution)

    def slowness(self, obstacles: np.ndarray, robot: Optional[Pose]) -> np.ndarray:
        """Cost per cell, infinity = blocked, with obstacle points (n, 2) beside the map's walls."""
        options, grid = self._options, self.grid
        distance = self.wall_distance
        if len(obstacles):
            distance = distance_to((grid.cells > 50) | self.mask(obstacles), grid.resolution)
        least, most = options.inscribed_radius, options.inflation_radius
        near = np.clip((most - distance) / (most - least), 0.0, 1.0)
        slowness = (1.0 + NEAR_WALL_COST * near * near).astype(np.float32)
        blocked = distance < least
        if not options.allow_unknown:
            blocked |= grid.cells < 0
        slowness[blocked] = np.inf
        if robot is not None:
            self._open_around(robot, slowness, distance)
        return slowness

    def mask(self, points: np.ndarray) -> np.ndarray:
        """Cells (rows, columns) that hold one of the points (n, 2)."""
        rows, columns = self.grid.cells.shape
        mask = np.zeros((rows, columns), dtype=bool)
        cells = np.floor((points - self.grid.origin) / self.grid.resolution).astype(np.int64)
        cells = cells[(cells >= 0).all(axis=1) & (cells[:, 0] < columns) & (cells[:, 1] < rows)]
        mask[cells[:, 1], cells[:, 0]] = True
        return mask

    def _open_around(self, robot: Pose, slowness: np.ndarray, distance: np.ndarray) -> None:
        """Where the robot stands it can stand: lets a way begin too near to a wall or in cells not seen."""
        row, column = self.grid.cell(robot[0], robot[1])
        if not self.grid.contains(row, column) or np.isfinite(slowness[row, column]):
            return
        reach = math.ceil(ESCAPE_RADIUS / self.grid.resolution)
        rows = slice(max(0, row - reach), row + reach + 1)
        columns = slice(max(0, column - reach), column + reach + 1)
        window = slowness[rows, columns]
        window[~np.isfinite(window) & (distance[rows, columns] > 0.0)] = ESCAPE_COST


def without_robots(grid: Grid, positions: List[Tuple[float, float]]) -> Grid:
    """The grid without the small isolated obstacles where robots stand. `explorer` has the same rule."""
    if not positions:
        return grid
    cells = grid.cells.copy()
    # An obstacle that is small and near enough lies wholly in the window, so one cut off at its edge is never taken.
    reach = int((ROBOT_REACH + ROBOT_EXTENT) / grid.resolution) + 2
    for x, y in positions:
        row, column = grid.cell(x, y)
        top, left = max(0, row - reach), max(0, column - reach)
        window = cells[top : max(0, row + reach + 1), left : max(0, column + reach + 1)]
        if not (window > 50).any():
            continue
        _, labels, statistics, middles = cv2.connectedComponentsWithStats(
            (window > 50).astype(np.uint8), connectivity=8
        )
        extent = np.maximum(statistics[:, cv2.CC_STAT_WIDTH], statistics[:, cv2.CC_STAT_HEIGHT]) * grid.resolution
        middles_x = grid.origin[0] + (middles[:, 0] + left + 0.5) * grid.resolution
        middles_y = grid.origin[1] + (middles[:, 1] + top + 0.5) * grid.resolution
        near = np.hypot(middles_x - x, middles_y - y) <= ROBOT_REACH
        robots = near & (extent <= ROBOT_EXTENT + 1e-9)
        robots[0] = False  # the ground between the obstacles
        window[robots[labels]] = 0
    return Grid(cells, grid.resolution, grid.origin)


def distance_to(mask: np.ndarray, resolution: float) -> np.ndarray:
    """Metres from each cell's centre to the nearest cell of the mask, float32; large when the mask is empty."""
    if not mask.any():
        return np.full(mask.shape, 1e3, dtype=np.float32)
    return cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * np.float32(resolution)


def plan(
    costs: CostMap, obstacles: np.ndarray, robot: Pose, goal: Tuple[float, float], search_radius: float
) -> Optional[Plan]:
    """The way from `robot` to `goal`, or to the nearest reachable point within `search_radius`; None: no way."""
    grid = costs.grid
    start = grid.cell(robot[0], robot[1])
    if not grid.contains(*start):
        return None
    slowness = costs.slowness(obstacles, robot)
    row, column = grid.cell(*goal)
    if grid.contains(row, column) and np.isfinite(slowness[row, column]):
        cost = _march(slowness, [(row, column, 0.0)], start, grid)
        if np.isfinite(cost[start]):
            return Plan(grid, cost, goal, True)
    seeds = _seeds_near(slowness, row, column, search_radius / grid.resolution)
    if not seeds:
        return None
    cost = _march(slowness, seeds, start, grid)
    if not np.isfinite(cost[start]):
        return None
    end = path(Plan(grid, cost, goal, False), robot)[-1]
    return Plan(grid, cost, end, False)


def _march(slowness: np.ndarray, seeds: List[Tuple[int, int, float]], start: Tuple[int, int], grid: Grid) -> np.ndarray:
    return _navigation.march(slowness, seeds, start, FIELD_MARGIN / grid.resolution)


def _seeds_near(slowness: np.ndarray, row: int, column: int, radius: float) -> List[Tuple[int, int, float]]:
    """Open cells around a goal; being off the goal costs more than any way around saves."""
    reach = math.ceil(radius)
    seeds = []
    for r in range(max(0, row - reach), min(slowness.shape[0], row + reach + 1)):
        for c in range(max(0, column - reach), min(slowness.shape[1], column + reach + 1)):
            off = math.hypot(r - row, c - column)
            if off <= radius and np.isfinite(slowness[r, c]):
                seeds.append((r, c, 10.0 * off))
    return seeds


def path(way: Plan, robot: Pose) -> List[Tuple[float, float]]:
    """Cell centres down the cost to go, from the robot to the point led to."""
    row, column = way.grid.cell(robot[0], robot[1])
    points = []
    rows, columns = way.cost.shape
    for _ in range(PATH_STEPS):
        points.append(way.grid.center(row, column))
        low_row, low_column = max(0, row - 1), max(0, column - 1)
        window = way.cost[low_row : min(rows, row + 2), low_column : min(columns, column + 2)]
        best = np.unravel_index(int(np.argmin(window)), window.shape)
        if window[best] >= way.cost[row, column]:
            break
        row, column = low_row + int(best[0]), low_column + int(best[1])
    return points
