"""Paths of robots that wander through a floor plan."""

import math
from typing import Optional, Tuple

import cv2
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from mr_plans import FloorPlan

from .scanning import Survey

_COARSE = 4
"""Cells of the floor plan per node of the path planner."""


class Wanderer:
    """Shortest paths between random places of a floor plan, at least `clearance` (m) away from walls."""

    def __init__(self, plan: FloorPlan, clearance: float) -> None:
        self._cell = plan.resolution * _COARSE
        kernel = 2 * math.ceil(clearance / plan.resolution) + 1
        blocked = cv2.dilate(plan.walls.astype(np.uint8), np.ones((kernel, kernel), np.uint8))
        rows, columns = (size // _COARSE * _COARSE for size in blocked.shape)
        blocks = blocked[:rows, :columns].reshape(rows // _COARSE, _COARSE, columns // _COARSE, _COARSE)
        self._open = blocks.max(axis=(1, 3)) == 0
        self._graph = _lattice_graph(self._open)

    def path(self, random: np.random.Generator, survey: Survey, start: Optional[Tuple[float, float]]) -> np.ndarray:
        """Points (n, 2) in metres, one per step of the survey, from `start` (anywhere if None) over random places."""
        open_nodes = np.flatnonzero(self._open)
        node = int(random.choice(open_nodes)) if start is None else self._node_at(start)
        points = [self._centre(node)]
        travelled = 0.0
        while travelled < survey.path_length:
            distance, before = dijkstra(self._graph, indices=node, return_predecessors=True, limit=15.0 / self._cell)
            reachable = np.flatnonzero(np.isfinite(distance) & (distance > 1.0 / self._cell))
            if reachable.size == 0:
                break
            goal = int(random.choice(reachable))
            leg = [goal]
            while leg[-1] != node:
                leg.append(int(before[leg[-1]]))
            for step in leg[::-1][1:]:
                points.append(self._centre(step))
                travelled += float(np.hypot(*(points[-1] - points[-2])))
                if travelled >= survey.path_length:
                    break
            node = goal
        return _resampled(np.array(points), survey.step)

    def _node_at(self, place: Tuple[float, float]) -> int:
        rows, columns = np.nonzero(self._open)
        x, y = (columns + 0.5) * self._cell, (rows + 0.5) * self._cell
        nearest = int(np.argmin(np.hypot(x - place[0], y - place[1])))
        return int(rows[nearest] * self._open.shape[1] + columns[nearest])

    def _centre(self, node: int) -> np.ndarray:
        row, column = divmod(node, self._open.shape[1])
        return np.array([(column + 0.5) * self._cell, (row + 0.5) * self._cell])


def _resampled(points: np.ndarray, step: float) -> np.ndarray:
    if len(points) < 2:
        return points
    along = np.concatenate([[0.0], np.hypot(*np.diff(points, axis=0).T).cumsum()])
    wanted = np.arange(0.0, along[-1], step)
    return np.column_stack([np.interp(wanted, along, points[:, axis]) for axis in (0, 1)])


def _lattice_graph(open_cells: np.ndarray) -> coo_matrix:
    rows, columns = open_cells.shape
    index = np.arange(rows * columns).reshape(rows, columns)
    begins, ends, costs = [], [], []
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here = (slice(0, rows - down), slice(max(0, -right), columns - max(0, right)))
        there = (slice(down, rows), slice(max(0, right), columns + min(0, right)))
        both = open_cells[here] & open_cells[there]
        begins.append(index[here][both])
        ends.append(index[there][both])
        costs.append(np.full(int(both.sum()), math.hypot(down, right)))
    begin, end, cost = (np.concatenate(parts) for parts in (begins, ends, costs))
    size = rows * columns
    return coo_matrix(
        (np.concatenate([cost, cost]), (np.concatenate([begin, end]), np.concatenate([end, begin]))), shape=(size, size)
    ).tocsr()
