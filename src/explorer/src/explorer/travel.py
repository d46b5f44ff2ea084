"""Where the robot can stand, and what it costs to get there: distances along paths over the known free cells.

The fields are computed on a grid of reduced resolution (`TravelGrid`) by Dijkstra's algorithm in compiled code
(`_kernels.WeightedGrid`): a building of 26 m x 15 m takes some 2 ms.
"""

import math
from functools import cached_property
from typing import List, Optional, Sequence, Tuple

import numpy as np

from explorer._kernels import WeightedGrid, cells_near, distances_to, pooled_maximum
from explorer.grid import GridInfo, OccupancyMap
from explorer.traces import robot_traces

# Traversable cells beyond which the next coarser grid is taken: bounds the time of one field to about 10 ms.
MAXIMUM_CELLS = 80_000

# Farther than this from any traversable cell a robot or a goal counts as outside of the known free space, in metres.
SNAP_DISTANCE = 0.8

# A comfortable place keeps this far from unknown cells, in metres.
UNKNOWN_CLEARANCE = 0.3


class CostField:
    """Path lengths from one place to all cells of a `TravelGrid`.

    `cost` is float64 (rows, cols) in metres (weighted near obstacles, so at least the true length), infinite where
    no path leads.
    """

    def __init__(self, grid: "TravelGrid", cost: np.ndarray) -> None:
        self.grid = grid
        self.cost = cost

    @cached_property
    def reachable(self) -> np.ndarray:
        return np.isfinite(self.cost)

    def at(self, x: float, y: float) -> float:
        """Cost in metres at the reachable cell nearest to a point, infinite if none is within `SNAP_DISTANCE`."""
        cell = self.grid.nearest(self.reachable, x, y, SNAP_DISTANCE)
        return math.inf if cell is None else float(self.cost[cell])

    def nearest_place(self, x: float, y: float) -> Tuple[float, float]:
        """Centre in metres of the reachable cell nearest to a point, however far; there must be one."""
        cells = np.argwhere(self.reachable)
        row, col = self.grid.info.cell_of(x, y)
        best = cells[int(np.argmin(np.hypot(cells[:, 0] - row, cells[:, 1] - col)))]
        return self.grid.info.centre_of(int(best[0]), int(best[1]))

    def path_to(self, x: float, y: float) -> List[Tuple[float, float]]:
        """Points in metres from the field's origin to the reachable cell nearest to (x, y); empty without a path."""
        cell = self.grid.nearest(self.reachable, x, y, SNAP_DISTANCE)
        if cell is None:
            return []
        return [self.grid.info.centre_of(row, col) for row, col in self.grid.weighted.path_to(*cell, self.cost)]


class TravelGrid:
    """The cells at which the robot's centre may be, and what it costs to cross them.

    A fine cell is traversable if it is known free and no occupied cell is nearer than `radius`; unknown cells are
    kept clear of as well, but only by one cell. A coarse cell is traversable if one of its fine cells is, so that a
    doorway is not lost in rounding. Cells nearer than `comfort` to an obstacle cost up to three times their length.
    """

    def __init__(
        self,
        occupancy: OccupancyMap,
        radius: float,
        comfort: float,
        robots: Sequence[Tuple[float, float]] = (),
        cell: float = 0.1,
        like: Optional["TravelGrid"] = None,
    ) -> None:
        """`cell`: edge length in metres of the coarse cells, more where the map is too large. `robots`: positions of
        the other robots in metres; the small isolated obstacles that the map shows there are taken for the robots.
        `like`: a grid whose fine cells are taken over if they are of the same map and radius with the same robots.
        """
        self.fine: _FineCells = _FineCells.of(occupancy, radius, robots, None if like is None else like.fine)
        self.occupied = self.fine.occupied
        self.factor = self._factor_for(self.fine.count, cell)
        self.info: GridInfo = self._coarse_info(occupancy.info)
        # The greatest of a cell's fine cells, -1 where none is allowed.
        self.coarse_clearance = pooled_maximum(self.fine.clearance, self.fine.allowed, self.factor)
        self.traversable = self.coarse_clearance >= 0
        weight = 1.0 + 2.0 * np.clip(1.0 - self.coarse_clearance / comfort, 0.0, 1.0)
        weight[~self.traversable] = math.inf
        self.weighted: WeightedGrid = WeightedGrid(weight, self.info.resolution)

    @cached_property
    def away_from_unknown(self) -> np.ndarray:
        """Where the whole footprint stands on known ground, so that a goal there is not deep in the unknown."""
        comfortable = self.fine.allowed & ~self.fine.near_unknown
        return pooled_maximum(self.fine.clearance, comfortable, self.factor) >= 0

    def field_from(self, x: float, y: float) -> CostField:
        """Costs from a point in metres; all infinite if the point is off the traversable cells by more than
        `SNAP_DISTANCE`."""
        start = self.nearest(self.traversable, x, y, SNAP_DISTANCE)
        if start is None:
            return CostField(self, np.full(self.traversable.shape, math.inf))
        return CostField(self, self.weighted.costs_from(*start))

    def nearest(self, mask: np.ndarray, x: float, y: float, distance: float) -> Optional[Tuple[int, int]]:
        """The cell of a bool array (rows, cols) that is set and nearest to a point in metres, or None."""
        return nearest_cell(mask, self.info, x, y, distance)

    def _factor_for(self, fine_cells: int, cell: float) -> int:
        resolution = self.fine.info.resolution
        factor = max(1, round(cell / resolution))
        while fine_cells / factor**2 > MAXIMUM_CELLS and factor * resolution < 0.25:
            factor += 1
        return factor

    def _coarse_info(self, fine: GridInfo) -> GridInfo:
        return GridInfo(
            fine.resolution * self.factor,
            -(-fine.width // self.factor),
            -(-fine.height // self.factor),
            fine.origin_x,
            fine.origin_y,
        )


def nearest_cell(mask: np.ndarray, info: GridInfo, x: float, y: float, distance: float) -> Optional[Tuple[int, int]]:
    """The cell of a bool array (rows, cols) that is set and nearest to a point, at most `distance` away, in metres."""
    row, col = info.cell_of(x, y)
    if info.contains(row, col) and mask[row, col]:
        return (row, col)
    reach = math.ceil(distance / info.resolution)
    top, left = max(0, row - reach), max(0, col - reach)
    window = mask[top : max(0, row + reach + 1), left : max(0, col + reach + 1)]
    cells = np.argwhere(window)
    if len(cells) == 0:
        return None
    cells += np.array((top, left))
    gap = np.hypot(cells[:, 0] - row, cells[:, 1] - col)
    best = int(np.argmin(gap))
    if gap[best] * info.resolution > distance:
        return None
    return (int(cells[best, 0]), int(cells[best, 1]))


class _FineCells:
    """What there is to know of the cells of a map itself, for a robot of a certain radius.

    `occupied`, `allowed`: bool arrays of the map's shape, the obstacles without robots and where the centre may be;
    `clearance`: float32, distance in metres to the nearest obstacle.
    """

    def __init__(self, occupancy: OccupancyMap, radius: float, robots: np.ndarray) -> None:
        self.info = occupancy.info
        self._made_of = (occupancy, radius, robots)
        free = occupancy.free | robots
        self.occupied = occupancy.occupied & ~robots
        if self.occupied.any():
            self.clearance = distances_to(self.occupied, self.info.resolution)
        else:
            self.clearance = np.full(self.occupied.shape, 1e3, dtype=np.float32)
        self.allowed = free & (self.clearance >= radius)
        self.count = int(np.count_nonzero(self.allowed))
        self._unknown = occupancy.unknown & ~free

    @classmethod
    def of(
        cls, occupancy: OccupancyMap, radius: float, robots: Sequence[Tuple[float, float]], like: Optional["_FineCells"]
    ) -> "_FineCells":
        traces = robot_traces(occupancy.occupied, occupancy.info, robots)
        if like is not None and like._are_of(occupancy, radius, traces):
            return like
        return cls(occupancy, radius, traces)

    def _are_of(self, occupancy: OccupancyMap, radius: float, robots: np.ndarray) -> bool:
        former = self._made_of
        return former[0] is occupancy and former[1] == radius and np.array_equal(former[2], robots)

    @cached_property
    def near_unknown(self) -> np.ndarray:
        """bool, of the map's shape: nearer than `UNKNOWN_CLEARANCE` to an unknown cell."""
        return cells_near(self._unknown, self.info.resolution, UNKNOWN_CLEARANCE)
