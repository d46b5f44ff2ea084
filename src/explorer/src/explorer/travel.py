"""Where the robot can stand, and what it costs to get there: distances along paths over the known free cells.

The fields are computed on a grid of reduced resolution (`TravelGrid`) by Dijkstra's algorithm in compiled code
(`_kernels.WeightedGrid`): a building of 26 m x 15 m takes some 2 ms.
"""

import math
from functools import cached_property
from typing import List, Optional, Tuple

import numpy as np

from explorer._kernels import WeightedGrid
from explorer.grid import OccupancyMap
from explorer.ground import MOST_ROOM, Ground
from mr_grid import GridInfo

# Traversable cells beyond which the next coarser grid is taken: bounds the time of one field to about 10 ms.
MAXIMUM_CELLS = 80_000

# A viewpoint keeps this much farther from obstacles than the robot has to, where it can, in metres.
PREFERRED_ROOM = 0.1

# Farther than this from any traversable cell a robot or a goal counts as outside of the known free space, in metres.
SNAP_DISTANCE = 0.8


class CostField:
    """Path lengths from one place to all cells of a `TravelGrid`.

    `cost` is float64 (rows, cols) in metres (weighted near obstacles, so at least the true length), infinite where
    no path leads.
    """

    def __init__(self, grid: "TravelGrid", cost: np.ndarray, start: Optional[Tuple[int, int]] = None) -> None:
        """`start`: the cell of the place, if there is one."""
        self.grid = grid
        self.cost = cost
        self.start = start

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
        cell: float = 0.1,
        ground: Optional[Ground] = None,
    ) -> None:
        """`comfort`: at most `MOST_ROOM` more than the radius. `cell`: edge length in metres of the coarse cells, more
        where the map is too large. `ground`: of this map and the robots on it; without it all obstacles are walls."""
        if comfort > radius + MOST_ROOM + 1e-9:
            raise ValueError(f"a comfortable clearance of {comfort:g} m is more than {radius + MOST_ROOM:g} m")
        self.ground: Ground = Ground.of(occupancy, radius, (), 0.0) if ground is None else ground
        self.occupied = self.ground.layers.occupied
        self.factor = factor_for(self.ground, cell)
        self.info: GridInfo = self._coarse_info(occupancy.info)
        # `away_from_unknown`: where the whole footprint stands on known ground, so that a goal there is not deep in the
        # unknown.
        self.coarse_clearance, self.away_from_unknown = self.ground.pools(self.factor)
        self.traversable = self.coarse_clearance >= 0
        weight = np.maximum(1.0 - self.coarse_clearance / comfort, 0.0)
        np.minimum(weight, 1.0, out=weight)
        weight *= 2.0
        weight += 1.0
        weight[~self.traversable] = math.inf
        self.weighted: WeightedGrid = WeightedGrid(weight, self.info.resolution)

    @cached_property
    def comfortable(self) -> np.ndarray:
        """bool (rows, cols): where the robot has room to look around, `PREFERRED_ROOM` more than it must keep, on known
        ground."""
        return (self.coarse_clearance >= self.ground.radius + PREFERRED_ROOM) & self.away_from_unknown

    def field_from(self, x: float, y: float, former: Optional[CostField] = None) -> CostField:
        """Costs from a point in metres; all infinite if the point is off the traversable cells by more than
        `SNAP_DISTANCE`. `former`: any earlier field; it is returned itself where nothing has changed."""
        start = self.nearest(self.traversable, x, y, SNAP_DISTANCE)
        if start is None:
            return CostField(self, np.full(self.traversable.shape, math.inf))
        if former is not None and former.grid is self and former.start == start:
            return former
        return CostField(self, self.weighted.costs_from(*start), start)

    def clearance_at(self, x: float, y: float) -> float:
        """m to the nearest obstacle from a traversable cell at a point in metres; see `Ground` for the most."""
        return float(self.coarse_clearance[self.info.cell_of(x, y)])

    def nearest(self, mask: np.ndarray, x: float, y: float, distance: float) -> Optional[Tuple[int, int]]:
        """The cell of a bool array (rows, cols) that is set and nearest to a point in metres, or None."""
        return nearest_cell(mask, self.info, x, y, distance)

    def _coarse_info(self, fine: GridInfo) -> GridInfo:
        return GridInfo(
            -(-fine.width // self.factor), -(-fine.height // self.factor), fine.resolution * self.factor, fine.origin
        )


def factor_for(ground: Ground, cell: float) -> int:
    """Of fine cells to a coarse one, whose edge is to be `cell` metres long."""
    resolution = ground.occupancy.info.resolution
    factor = max(1, round(cell / resolution))
    while ground.count / factor**2 > MAXIMUM_CELLS and factor * resolution < 0.25:
        factor += 1
    return factor


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
