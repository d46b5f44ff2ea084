"""Ways through a map: costs near walls, cost to go to a goal by fast marching, paths down that cost."""

import math
from dataclasses import dataclass, replace
from typing import List, Optional, Tuple

import numpy as np

from mr_grid import OccupancyGrid, Pose
from mr_grid.robot_traces import cells_without_robots
from mr_robot import _navigation
from mr_robot.navigation.driven import DrivenGround
from mr_robot.navigation.options import REACH, NavigationOptions

NEAR_WALL_COST = 6.0  # a cell at the wall costs this much more than a free one
# Of a cell where the body fits through and has no margin, and around a robot that stands in its margin.
NARROW_COST = 2.0 * NEAR_WALL_COST


Seeds = Tuple[Tuple[int, int, float], ...]
"""Cells (row, column) with the cost to go from there."""


@dataclass(frozen=True)
class Plan:
    """`cost`: float32 (rows, columns), cells of way still to go, infinity = not computed or no way."""

    grid: OccupancyGrid
    cost: np.ndarray
    goal: Tuple[float, float]  # the point led to: the goal asked for, or one near it that can be reached
    exact: bool  # whether it is the goal asked for
    slowness: np.ndarray  # float32 (rows, columns) that the cost was computed from
    seeds: Seeds  # cells that the cost was computed from
    start: Tuple[int, int]  # cell of the robot; the cost goes REACH beyond what it has there

    def cost_at(self, x: float, y: float) -> float:
        """Metres of free way from (x, y), infinity where there is none."""
        row, column = self.grid.info.cell_of(x, y)
        if not self.grid.info.contains(row, column):
            return math.inf
        return float(self.cost[row, column]) * self.grid.resolution


class CostMap:
    """Distances to walls of one map, m, infinity where walls do not slow down, and slowness for planning over it."""

    def __init__(
        self,
        grid: OccupancyGrid,
        options: NavigationOptions,
        former: Optional["CostMap"] = None,
        driven: Optional[DrivenGround] = None,
    ) -> None:
        """`former`: any earlier one with the same options; only what has changed since is computed again. `driven`:
        where the body has been."""
        self.grid, self.options = grid, options
        self._driven = driven or DrivenGround()
        self._narrow: Optional[np.ndarray] = None
        self._inflation = _navigation.Inflation(options.inscribed_radius, options.inflation_radius, NEAR_WALL_COST)
        reach = math.ceil(options.inflation_radius / grid.resolution) + 1  # one more for what rounding leaves
        changed = None if former is None else _changed(former.grid, grid, reach)
        if former is None or changed is None:
            self.wall_distance, self._of_walls = self._inflated(grid.cells, options)
        else:
            # What lies twice as far away has no influence on what may have changed.
            seen, inner = _grown(changed, reach, grid.cells.shape)
            distance, slowness = self._inflated(grid.cells[seen], options)
            self.wall_distance, self._of_walls = former.wall_distance.copy(), former._of_walls.copy()
            self.wall_distance[changed], self._of_walls[changed] = distance[inner], slowness[inner]
        self.walls = _navigation.Walls(grid.cells, self.wall_distance, grid.resolution, grid.origin[:2])

    def _inflated(self, cells: np.ndarray, options: NavigationOptions) -> Tuple[np.ndarray, np.ndarray]:
        return _navigation.inflate(
            np.ascontiguousarray(cells), self.grid.resolution, self._inflation, not options.allow_unknown
        )

    def slowness(self, obstacles: np.ndarray, robot: Optional[Pose], narrow: bool = False) -> np.ndarray:
        """Cost per cell, float32 (rows, columns), infinity = blocked, with obstacle points (n, 2) beside the map's
        walls. `narrow`: also between walls where only the body fits or has been. Not to be written to."""
        slowness, cells = self._with_narrow_places() if narrow else self._of_walls, self._cells_of(obstacles)
        if len(cells):
            slowness = _navigation.slower_around(slowness, cells, self.grid.resolution, self._inflation)
        return slowness if robot is None else self._open_around(robot, slowness, cells)

    def is_open(self, points: np.ndarray, off: float) -> np.ndarray:
        """bool (n,), of points (n, 2): on free ground, more than `off`, m, from walls."""
        cells = self.grid.info.cells_of(points)
        open_: np.ndarray = self.grid.info.inside(cells)
        rows, columns = cells[open_].T
        known = (self.grid.cells[rows, columns] >= 0) & (self.wall_distance[rows, columns] > off)
        open_[open_] = known
        return open_

    def _with_narrow_places(self) -> np.ndarray:
        if self._narrow is None:
            fits = self.wall_distance >= self.options.half_width
            rows, columns = self._driven.cells_of(self.grid.info).T
            fits[rows, columns] = True
            fits &= (self.grid.cells <= 50) & ~np.isfinite(self._of_walls)
            if not self.options.allow_unknown:
                fits &= self.grid.cells >= 0
            self._narrow = np.where(fits, np.float32(NARROW_COST), self._of_walls)
        return self._narrow

    def _cells_of(self, points: np.ndarray) -> np.ndarray:
        """Cells of the map (row, column), int64 (k, 2), of points (n, 2)."""
        cells = self.grid.info.cells_of(points)
        return cells[self.grid.info.inside(cells)]

    def _open_around(self, robot: Pose, slowness: np.ndarray, obstacles: np.ndarray) -> np.ndarray:
        """Where the robot stands it can stand: lets a way begin too near to a wall or in cells not seen.
        `obstacles`: cells (n, 2)."""
        row, column = self.grid.info.cell_of(robot[0], robot[1])
        if not self.grid.info.contains(row, column) or np.isfinite(slowness[row, column]):
            return slowness
        reach = math.ceil(
            round(self.options.inscribed_radius + 2.0 * self.options.moving_margin, 3) / self.grid.resolution
        )
        top, left = max(0, row - reach), max(0, column - reach)
        slowness = slowness.copy()
        window = slowness[top : row + reach + 1, left : column + reach + 1]
        walls = self.grid.cells[top : row + reach + 1, left : column + reach + 1] > 50
        inside = obstacles - (top, left)
        inside = inside[((inside >= 0) & (inside < window.shape)).all(axis=1)]
        walls[inside[:, 0], inside[:, 1]] = True
        window[~np.isfinite(window) & ~walls] = NARROW_COST
        return slowness


Window = Tuple[slice, slice]
"""Of rows and columns."""


def _changed(before: OccupancyGrid, after: OccupancyGrid, reach: int) -> Optional[Window]:
    """The cells within `reach` of those that differ; None if that is most of the grid or the grids are of different
    places."""
    if before.info != after.info:
        return None
    differs = before.cells != after.cells
    rows = differs.any(axis=1).nonzero()[0]
    if not rows.size:
        return slice(0, 0), slice(0, 0)
    columns = differs[rows[0] : rows[-1] + 1].any(axis=0).nonzero()[0]
    window, _ = _grown((slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)), reach, differs.shape)
    return window if 2 * differs[window].size < differs.size else None


def _grown(window: Window, reach: int, shape: Tuple[int, ...]) -> Tuple[Window, Window]:
    """The window with `reach` cells more on each side as far as the grid goes, and where in it the old one lies."""
    larger = tuple(slice(max(0, s.start - reach), min(n, s.stop + reach)) for s, n in zip(window, shape))
    inner = tuple(slice(s.start - g.start, s.stop - g.start) for s, g in zip(window, larger))
    return (larger[0], larger[1]), (inner[0], inner[1])


def without_robots(grid: OccupancyGrid, positions: List[Tuple[float, float]], radius: float) -> OccupancyGrid:
    """The grid without the small isolated obstacles where robots stand; itself where there are none. `radius`: of the
    largest, m."""
    cells = cells_without_robots(grid, positions, radius, occupied_from=51)
    return grid if cells is grid.cells else OccupancyGrid(grid.info, cells)


def plan(
    costs: CostMap,
    obstacles: np.ndarray,
    robot: Pose,
    goal: Tuple[float, float],
    search_radius: float,
    former: Optional[Plan] = None,
    narrow: bool = False,
) -> Optional[Plan]:
    """The way from `robot` to `goal`, or to the nearest reachable point within `search_radius`; None: no way.
    `former`: any earlier plan; what still holds of it is not computed again, the result is the same. `narrow`: also
    through places where only the body fits or has been."""
    grid = costs.grid
    start = grid.info.cell_of(robot[0], robot[1])
    if not grid.info.contains(*start):
        return None
    slowness = costs.slowness(obstacles, robot, narrow)
    row, column = grid.info.cell_of(*goal)
    if grid.info.contains(row, column) and np.isfinite(slowness[row, column]):
        seeds: Seeds = ((row, column, 0.0),)
        cost = _march(slowness, seeds, start, grid, former)
        if np.isfinite(cost[start]):
            return Plan(grid, cost, goal, True, slowness, seeds, start)
    seeds = _seeds_near(slowness, row, column, search_radius / grid.resolution)
    if not seeds:
        return None
    cost = _march(slowness, seeds, start, grid, former)
    if not np.isfinite(cost[start]):
        return None
    end = path(Plan(grid, cost, goal, False, slowness, seeds, start), robot)[-1]
    return Plan(grid, cost, end, False, slowness, seeds, start)


def _march(
    slowness: np.ndarray, seeds: Seeds, start: Tuple[int, int], grid: OccupancyGrid, former: Optional[Plan]
) -> np.ndarray:
    beside = None
    if former is not None and former.seeds == seeds and former.cost.shape == slowness.shape:
        # Nothing has changed, and a robot that has come nearer needs no more than was computed.
        if former.slowness is slowness and former.cost[start] <= former.cost[former.start]:
            return former.cost
        beside = (former.slowness, former.cost)
    return _navigation.march(slowness, seeds, start, REACH / grid.resolution, former=beside)


def _seeds_near(slowness: np.ndarray, row: int, column: int, radius: float) -> Seeds:
    """Open cells around a goal; being off the goal costs more than any way around saves."""
    reach = math.ceil(radius)
    top, left = max(0, row - reach), max(0, column - reach)
    window = slowness[top : max(0, row + reach + 1), left : max(0, column + reach + 1)]
    rows, columns = np.nonzero(np.isfinite(window))
    off = np.hypot(rows + top - row, columns + left - column)
    near = off <= radius
    return tuple(zip((rows[near] + top).tolist(), (columns[near] + left).tolist(), (10.0 * off[near]).tolist()))


def from_here(way: Plan, robot: Pose) -> Plan:
    """The same way from where the robot is now, through the map that it was planned on; itself where there is none."""
    start = way.grid.info.cell_of(robot[0], robot[1])
    if not way.grid.info.contains(*start) or np.isfinite(way.cost[start]):
        return way
    cost = _march(way.slowness, way.seeds, start, way.grid, way)
    return replace(way, cost=cost, start=start) if np.isfinite(cost[start]) else way


def path(way: Plan, robot: Pose) -> List[Tuple[float, float]]:
    """Cell centres down the cost to go, from the robot to the point led to; none for a robot off the map."""
    start = way.grid.info.cell_of(robot[0], robot[1])
    if not way.grid.info.contains(*start):
        return []
    cells = _navigation.descend(way.cost, start, way.cost.size)
    return [way.grid.info.centre_of(row, column) for row, column in cells]
