"""Where the robot can stand, and what it costs to get there: distances along paths over the known free cells.

The fields are computed on a grid of reduced resolution (`TravelGrid`) by Dijkstra's algorithm in compiled code
(`scipy.sparse.csgraph`): a building of 26 m x 15 m takes some 20 ms, 60 m x 60 m some 80 ms.
"""

import math
from typing import List, Optional, Sequence, Tuple

import cv2
import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import dijkstra

from explorer.grid import GridInfo, OccupancyMap
from explorer.traces import robot_traces

# Nodes of the graph beyond which the next coarser grid is taken: bounds the time of one field to about 80 ms.
MAXIMUM_NODES = 80_000

# Farther than this from any traversable cell a robot or a goal counts as outside of the known free space, in metres.
SNAP_DISTANCE = 0.8

# A comfortable place keeps this far from unknown cells, in metres.
UNKNOWN_CLEARANCE = 0.3


class CostField:
    """Path lengths from one place to all cells of a `TravelGrid`.

    `cost` is float64 (rows, cols) in metres (weighted near obstacles, so at least the true length), infinite where
    no path leads; `previous` holds for each node its predecessor.
    """

    def __init__(self, grid: "TravelGrid", cost: np.ndarray, previous: Optional[np.ndarray]) -> None:
        self.grid = grid
        self.cost = cost
        self._previous = previous

    @property
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
        if cell is None or self._previous is None:
            return []
        node = int(self.grid.node_of[cell])
        nodes = [node]
        while self._previous[node] >= 0:
            node = int(self._previous[node])
            nodes.append(node)
        cells = self.grid.cell_of_node[nodes[::-1]]
        return [(float(x), float(y)) for x, y in self.grid.info.centres_of(cells)]


class TravelGrid:
    """The cells at which the robot's centre may be, and the graph over them.

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
    ) -> None:
        """`cell`: edge length in metres of the coarse cells, more where the map is too large. `robots`: positions of
        the other robots in metres; the small isolated obstacles that the map shows there are taken for the robots."""
        self.fine = occupancy.info
        robot = robot_traces(occupancy.occupied, occupancy.info, robots)
        free = occupancy.free | robot
        occupied = occupancy.occupied & ~robot
        self.occupied = occupied
        self.clearance = self._distance_to(occupied)
        allowed = free & (self.clearance >= radius)
        self.factor = self._factor_for(int(np.count_nonzero(allowed)), cell)
        self.info = self._coarse_info()
        coarse_clearance = self._pool(np.where(allowed, self.clearance, -1.0))
        self.traversable = coarse_clearance >= 0
        self.coarse_clearance = coarse_clearance
        # Where the whole footprint stands on known ground, so that a goal there is not deep in the unknown.
        known = self._distance_to(occupancy.unknown & ~free)
        self.away_from_unknown = self._pool(np.where(allowed, known, -1.0)) >= UNKNOWN_CLEARANCE
        self._weight = 1.0 + 2.0 * np.clip(1.0 - coarse_clearance / comfort, 0.0, 1.0)
        self.node_of = np.full(self.traversable.shape, -1, dtype=np.int32)
        self.cell_of_node = np.argwhere(self.traversable)
        self.node_of[self.traversable] = np.arange(len(self.cell_of_node), dtype=np.int32)
        self._graph: Optional[csr_matrix] = None

    def field_from(self, x: float, y: float, with_paths: bool = False) -> CostField:
        """Costs from a point in metres; all infinite if the point is off the traversable cells by more than
        `SNAP_DISTANCE`."""
        cost = np.full(self.traversable.shape, math.inf)
        start = self.nearest(self.traversable, x, y, SNAP_DISTANCE)
        if start is None:
            return CostField(self, cost, None)
        node = int(self.node_of[start])
        previous = None
        if with_paths:
            distances, previous = dijkstra(self.graph, indices=node, return_predecessors=True)
        else:
            distances = dijkstra(self.graph, indices=node)
        cost[self.traversable] = distances
        return CostField(self, cost, previous)

    def nearest(self, mask: np.ndarray, x: float, y: float, distance: float) -> Optional[Tuple[int, int]]:
        """The cell of a bool array (rows, cols) that is set and nearest to a point in metres, or None."""
        row, col = self.info.cell_of(x, y)
        if self.info.contains(row, col) and mask[row, col]:
            return (row, col)
        reach = math.ceil(distance / self.info.resolution)
        top, left = max(0, row - reach), max(0, col - reach)
        window = mask[top : max(0, row + reach + 1), left : max(0, col + reach + 1)]
        cells = np.argwhere(window)
        if len(cells) == 0:
            return None
        cells += np.array((top, left))
        gap = np.hypot(cells[:, 0] - row, cells[:, 1] - col)
        best = int(np.argmin(gap))
        if gap[best] * self.info.resolution > distance:
            return None
        return (int(cells[best, 0]), int(cells[best, 1]))

    @property
    def graph(self) -> csr_matrix:
        """Sparse symmetric matrix (nodes, nodes) of the lengths of single steps in metres, 8 neighbours a cell."""
        if self._graph is None:
            self._graph = self._build_graph()
        return self._graph

    def _build_graph(self) -> csr_matrix:
        rows, cols = self.traversable.shape
        starts, ends, lengths = [], [], []
        for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
            here = np.s_[: rows - down, max(0, -right) : cols - max(0, right)]
            there = np.s_[down:, max(0, right) : cols + min(0, right)]
            both = self.traversable[here] & self.traversable[there]
            starts.append(self.node_of[here][both])
            ends.append(self.node_of[there][both])
            step = 0.5 * self.info.resolution * math.hypot(down, right)
            lengths.append((self._weight[here] + self._weight[there])[both] * step)
        start, end, length = np.concatenate(starts), np.concatenate(ends), np.concatenate(lengths)
        count = len(self.cell_of_node)
        both_ways = (np.concatenate([start, end]), np.concatenate([end, start]))
        return coo_matrix((np.concatenate([length, length]), both_ways), shape=(count, count)).tocsr()

    def _distance_to(self, occupied: np.ndarray) -> np.ndarray:
        """Distance in metres from each cell to the nearest occupied one (float32)."""
        if not occupied.any():
            return np.full(occupied.shape, 1e3, dtype=np.float32)
        return cv2.distanceTransform((~occupied).astype(np.uint8), cv2.DIST_L2, 5) * self.fine.resolution

    def _factor_for(self, fine_nodes: int, cell: float) -> int:
        factor = max(1, round(cell / self.fine.resolution))
        while fine_nodes / factor**2 > MAXIMUM_NODES and factor * self.fine.resolution < 0.25:
            factor += 1
        return factor

    def _coarse_info(self) -> GridInfo:
        fine = self.fine
        return GridInfo(
            fine.resolution * self.factor,
            -(-fine.width // self.factor),
            -(-fine.height // self.factor),
            fine.origin_x,
            fine.origin_y,
        )

    def _pool(self, values: np.ndarray) -> np.ndarray:
        """Largest value of each block of `factor` x `factor` fine cells."""
        factor, info = self.factor, self.info
        padded = np.full((info.height * factor, info.width * factor), -1.0, dtype=np.float32)
        padded[: values.shape[0], : values.shape[1]] = values
        pooled = padded[::factor, ::factor].copy()
        # Many times faster than one reduction over two short axes.
        for row, col in np.ndindex(factor, factor):
            np.maximum(pooled, padded[row::factor, col::factor], out=pooled)
        return pooled
