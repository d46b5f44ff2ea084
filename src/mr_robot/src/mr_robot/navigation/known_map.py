"""The map that ways are planned on: the latest one without what moves."""

from typing import List, Optional, Tuple

from mr_grid import FARTHEST, OccupancyGrid, Pose, is_place
from mr_robot import _navigation
from mr_robot.navigation.arrivals import Arrivals
from mr_robot.navigation.driven import DrivenGround
from mr_robot.navigation.options import NavigationError, NavigationOptions
from mr_robot.navigation.planner import CostMap, without_robots

MOST_ROTATION = 1e-3  # rad: kernels take cells to lie along the axes of the frame


class KnownMap:
    def __init__(self, options: NavigationOptions) -> None:
        self._options = options
        self._grid: Optional[OccupancyGrid] = None
        self._arrivals = Arrivals(2.0 * options.blocked_timeout)
        self._driven = DrivenGround()
        self._costs: Optional[CostMap] = None
        self._robots: List[Tuple[float, float]] = []
        self._costs_hold = False  # whether they are those of the present map and positions
        self._own: Optional[_navigation.Map] = None
        self._own_grid: Optional[OccupancyGrid] = None  # that it was made of
        self._own_holds = False

    def set_grid(self, grid: OccupancyGrid) -> None:
        """Raises NavigationError for a grid that is no map."""
        if 0 in grid.cells.shape:
            raise NavigationError(f"map has no cells: shape {grid.cells.shape}")
        _check_origin(grid)
        self._grid = grid
        self._costs_hold = False

    def set_own_grid(self, grid: OccupancyGrid, now: float) -> None:
        """What this robot's own SLAM says tells what moves. Raises NavigationError for a grid that is no map."""
        _check_origin(grid)
        self._arrivals.update(grid, now)
        self._costs_hold = False
        self._own_holds = False

    def set_robots(self, positions: List[Tuple[float, float]]) -> None:
        self._robots = positions
        self._costs_hold = False
        self._own_holds = False

    def be_at(self, pose: Pose) -> None:
        """Once per step: where the robot is it fits."""
        if self._grid is not None:
            self._driven.add(pose, self._grid.resolution)

    def costs(self, now: float) -> Optional[CostMap]:
        """None without a map. Robots that stood still long enough to enter it are no walls: what came lately is taken
        out, and them where they report."""
        if self._grid is None or self._costs_hold:
            return self._costs
        self._costs_hold = True
        grid = self._arrivals.taken_from(self._grid, now)
        grid = without_robots(grid, self._robots, self._options.largest_robot_radius)
        if self._costs is None or not grid.equals(self._costs.grid):
            self._costs = CostMap(grid, self._options, self._costs, self._driven)
        return self._costs

    @property
    def own(self) -> Optional[_navigation.Map]:
        """What the robot itself has mapped, without what moves."""
        settled = self._arrivals.settled
        if settled is not None and not self._own_holds:
            grid = without_robots(settled, self._robots, self._options.largest_robot_radius)
            if grid is not self._own_grid:
                self._own, self._own_grid = _navigation.Map(grid.cells, grid.resolution, grid.origin[:2]), grid
        self._own_holds = True
        return None if settled is None else self._own


def _check_origin(grid: OccupancyGrid) -> None:
    x, y, yaw = grid.origin
    if not is_place(x, y) or abs(yaw) > MOST_ROTATION:
        raise NavigationError(
            f"map needs an origin within {FARTHEST:g} m that is not rotated, not ({x:g}, {y:g}, {yaw:g})"
        )
