"""What a body can reach in a true world, and how soon: ways over (x, y, heading) that its footprint fits through.

Independent of navigation. Headings are those of steps to cells of the lattice, so no motion is rounded.
"""

import math
from functools import cached_property

import cv2
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from mr_grid import Pose, normalized
from mr_robot.platforms.platform import Drive
from mr_sim.bodies import Polygon
from mr_sim.raster import Grid, rasterise
from mr_sim.simulated_platform import platform_of
from mr_sim.world_description import WorldDescription

CELL = 0.06  # m of the lattice, a multiple of the resolution of a world
MARGIN = 0.01  # m around the footprint
GOAL_REACH = 0.12
# Looking farther than this costs seconds, and is done only where there is no way in that time.
USUAL_DETOUR, TURNING = 2.0, 4.0  # of the straight line; s
SWING = 0.1  # m that the front comes aside from one heading to the next, so that a body gets away from a wall

Step = tuple[int, int]
"""Cells along x and y."""
Edges = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Numbers of nodes, of the nodes they lead to, and seconds."""


class Reach:
    """Of one robot model in a world without other robots."""

    def __init__(self, world: WorldDescription) -> None:
        self._grid: Grid = rasterise(world.obstacles, world.resolution)
        self._polygons = world.robots[0].footprint
        platform = platform_of(world.robots[0])
        self.drive = platform.drive
        self._steps = _steps(platform.footprint.length / 2.0)
        self._headings = [math.atan2(y, x) for x, y in self._steps]
        self._every = round(CELL / world.resolution)
        free = (self._grid.cells == 0).astype(np.uint8)
        self._room = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * world.resolution
        self._known: dict[tuple[float, float], tuple[float, np.ndarray]] = {}

    def room(self, point: tuple[float, float]) -> float:
        """m to the nearest obstacle, 0 outside."""
        row, column = self._cell(point, self._grid.resolution)
        rows, columns = self._room.shape
        return float(self._room[row, column]) if 0 <= row < rows and 0 <= column < columns else 0.0

    def stands(self, pose: Pose, margin: float) -> bool:
        """Whether the footprint with a margin touches nothing there."""
        mask = self._mask(pose[2], margin)
        row, column = self._cell(pose[:2], self._grid.resolution)
        half = mask.shape[0] // 2
        padded = cv2.copyMakeBorder(self._grid.cells, half, half, half, half, cv2.BORDER_CONSTANT, value=1)
        if not (0 <= row < self._grid.cells.shape[0] and 0 <= column < self._grid.cells.shape[1]):
            return False
        return not (padded[row : row + mask.shape[0], column : column + mask.shape[1]] & mask).any()

    def seconds(self, start: Pose, goal: tuple[float, float]) -> float:
        """The least time from a pose to within reach of a goal, s; infinity if there is no way."""
        straight = math.dist(start[:2], goal) / self.drive.max_linear_velocity
        for limit in (USUAL_DETOUR * straight + TURNING, math.inf):
            best = self._seconds(start, self._field(goal, limit))
            if best <= limit:
                break
        return best

    def _field(self, goal: tuple[float, float], limit: float) -> np.ndarray:
        """Seconds (headings, rows, columns) to the goal; infinity may stand for more than the limit."""
        if goal not in self._known or self._known[goal][0] < limit:
            self._known[goal] = limit, self._from(goal, limit)
        return self._known[goal][1]

    def _seconds(self, start: Pose, field: np.ndarray) -> float:
        row, column = self._cell(start[:2], CELL)
        best = math.inf
        for dr in (-1, 0, 1):
            for dc in (-1, 0, 1):
                r, c = row + dr, column + dc
                if 0 <= r < field.shape[1] and 0 <= c < field.shape[2]:
                    turns = [abs(normalized(start[2] - heading)) for heading in self._headings]
                    nearest = sorted(range(len(turns)), key=lambda k: turns[k])[:2]
                    best = min([best, *(field[k, r, c] + turns[k] / self.drive.max_angular_velocity for k in nearest)])
        return float(best)

    def _from(self, goal: tuple[float, float], limit: float) -> np.ndarray:
        free = self._free
        rows, columns = np.indices(free.shape[1:])
        x = self._grid.origin[0] + (columns + 0.5) * CELL
        y = self._grid.origin[1] + (rows + 0.5) * CELL
        there = free & (np.hypot(x - goal[0], y - goal[1]) <= GOAL_REACH)
        sources = np.flatnonzero(there)
        if not sources.size:
            return np.full(free.shape, np.inf)
        seconds = dijkstra(self._graph, directed=False, indices=sources, min_only=True, limit=limit)
        return np.where(free, seconds.reshape(free.shape), np.inf)

    @cached_property
    def _graph(self) -> coo_matrix:
        return _graph(self._free, self._steps, self.drive)

    @cached_property
    def _free(self) -> np.ndarray:
        """bool (headings, rows, columns): whether the footprint fits there."""
        start = self._every // 2
        layers = [
            cv2.dilate(
                self._grid.cells, np.ascontiguousarray(self._mask(heading, MARGIN)[::-1, ::-1]),
                borderType=cv2.BORDER_CONSTANT, borderValue=1,
            )[start :: self._every, start :: self._every] == 0
            for heading in self._headings
        ]  # fmt: skip
        return np.array(layers)

    def _mask(self, heading: float, margin: float) -> np.ndarray:
        return _footprint_mask(self._polygons, heading, margin, self._grid.resolution)

    def _cell(self, point: tuple[float, float], size: float) -> tuple[int, int]:
        x, y = point
        return math.floor((y - self._grid.origin[1]) / size), math.floor((x - self._grid.origin[0]) / size)


def _footprint_mask(polygons: tuple[Polygon, ...], heading: float, margin: float, resolution: float) -> np.ndarray:
    """uint8 (odd, odd): cells around the middle one within `margin` of the footprint."""
    points = np.concatenate([np.array(polygon) for polygon in polygons])
    half = math.ceil((float(np.hypot(*points.T).max()) + margin) / resolution) + 1
    offsets = (np.arange(2 * half + 1) - half) * resolution
    dx, dy = np.meshgrid(offsets, offsets)
    c, s = math.cos(heading), math.sin(heading)
    x, y = c * dx + s * dy, -s * dx + c * dy
    (left, bottom), (right, top) = points.min(axis=0), points.max(axis=0)
    outside = np.hypot(np.maximum(np.maximum(left - x, x - right), 0), np.maximum(np.maximum(bottom - y, y - top), 0))
    return (outside <= margin + resolution / 2.0).astype(np.uint8)


def _steps(half_length: float) -> tuple[Step, ...]:
    """Of a whole turn. `half_length`: m, of the body; long ones have finer headings near the axes of the lattice."""
    along = max(2, math.ceil(half_length / SWING) - 1)
    coarse = ((1, 0), (2, 1), (1, 1), (1, 2))
    quarter = coarse if along == 2 else ((1, 0), (along, 1), *coarse[1:], (1, along))
    half = (*quarter, *((-y, x) for x, y in quarter))
    return (*half, *((-x, -y) for x, y in half))


def _graph(free: np.ndarray, steps: tuple[Step, ...], drive: Drive) -> coo_matrix:
    """Undirected, seconds: steps along the heading and turns to the next one."""
    headings = [math.atan2(y, x) for x, y in steps]
    numbers = np.arange(free.size).reshape(free.shape)
    edges: list[Edges] = []
    for k, (dx, dy) in enumerate(steps):
        following = (k + 1) % len(steps)
        both = free[k] & free[following]
        turn = abs(normalized(headings[following] - headings[k])) / drive.max_angular_velocity
        _add(numbers[k][both], numbers[following][both], turn, edges)
        if k >= len(steps) // 2:
            continue  # the same steps backwards
        for layer in (k, k + len(steps) // 2):
            here, there = _shifted(free.shape[1:], dx, dy)
            both = free[layer][here] & free[layer][there]
            seconds = CELL * math.hypot(dx, dy) / drive.max_linear_velocity
            _add(numbers[layer][here][both], numbers[layer][there][both], seconds, edges)
    shape = (free.size, free.size)
    starts, ends, weights = (np.concatenate(part) for part in zip(*edges))
    return coo_matrix((weights, (starts, ends)), shape=shape).tocsr()


def _shifted(shape: tuple[int, ...], dx: int, dy: int) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """Windows of cells and of the cells (dx, dy) beside them."""

    def pair(size: int, by: int) -> tuple[slice, slice]:
        return slice(max(0, -by), size - max(0, by)), slice(max(0, by), size - max(0, -by))

    (rows, rows_there), (columns, columns_there) = pair(shape[0], dy), pair(shape[1], dx)
    return (rows, columns), (rows_there, columns_there)


def _add(starts: np.ndarray, ends: np.ndarray, weight: float, edges: list[Edges]) -> None:
    edges.append((starts, ends, np.full(starts.shape, weight)))
