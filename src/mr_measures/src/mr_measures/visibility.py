"""From where the cells of a world can be seen, and how far a robot has to drive to get there."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Sequence

import cv2
import numpy as np
from scipy import ndimage, sparse
from scipy.sparse import csgraph

from mr_grid import Pose
from mr_measures.true_world import Polygon, TrueWorld

CELL = 0.05  # m, lattice on which places are told apart
MAP_CELL = 0.05  # m, of the maps whose coverage is bounded: a cell counts as known when any part of it is seen
BEAMS = 1440
PAD = 1.0  # m around the walls through which robots may drive

# Steps to the 16 nearest directions. A path of them is longer than a straight line by at most 1 / cos(13.3 deg).
STEPS = [(0, 1), (1, 0), (1, 1), (1, -1), (1, 2), (2, 1), (1, -2), (2, -1)]
STRETCH = 1.0 / math.cos(0.5 * math.atan2(1, 2))


@dataclass(frozen=True)
class Lattice:
    """Square cells over the world, row 0 at the lowest y; `origin`: lower left corner."""

    shape: tuple[int, int]
    origin: tuple[float, float]
    cell: float

    def index(self, points: np.ndarray) -> np.ndarray:
        """(row, column) as int (N, 2) of points (N, 2), possibly outside."""
        return np.floor((points - self.origin) / self.cell).astype(np.int64)[..., ::-1]


@dataclass(frozen=True)
class View:
    """Cells of a lattice from which something is seen: a window of rows and columns, and its mask as packed bits."""

    rows: slice
    columns: slice
    bits: np.ndarray

    @property
    def mask(self) -> np.ndarray:
        """Bool, of the window."""
        shape = self.rows.stop - self.rows.start, self.columns.stop - self.columns.start
        return np.unpackbits(self.bits, count=shape[0] * shape[1]).reshape(shape).astype(bool)

    def whole(self, shape: tuple[int, int]) -> np.ndarray:
        """Bool mask of the whole lattice."""
        cells = np.zeros(shape, dtype=bool)
        cells[self.rows, self.columns] = self.mask
        return cells

    def least(self, field: np.ndarray) -> float:
        """Least value of a field over the lattice among the cells of the view; infinite without any."""
        return float(field[self.rows, self.columns][self.mask].min(initial=np.inf))


class DrivingDistance:
    """Lower bounds on the distances that a robot's sensor travels between places of a world.

    They hold for the largest disc that fits into the footprint, on cells that are free when any part of them is, after
    taking away what the lattice adds to a straight line, what rounding to cells adds, and the arm of the sensor.
    """

    def __init__(self, world: TrueWorld) -> None:
        walls = world.solid
        block = max(1, round(CELL / walls.resolution))
        cell = block * walls.resolution
        pad = math.ceil(PAD / cell) * block
        rows, columns = (-n % block for n in walls.cells.shape)
        cells = np.pad(walls.cells, ((pad, pad + rows), (pad, pad + columns)))
        clearance = ndimage.distance_transform_edt(cells == 0) * walls.resolution
        coarse = clearance.reshape(cells.shape[0] // block, block, -1, block).max(axis=(1, 3))
        radius = min(inscribed_radius(robot.footprint) for robot in world.robots)
        x, y = walls.origin[:2]
        self.lattice = Lattice(coarse.shape, (x - pad * walls.resolution, y - pad * walls.resolution), cell)
        self.free = coarse >= radius - walls.resolution
        # At both ends: rounding to the centre of a cell, and a sliver of a view, thinner than a cell, that was missed.
        self._slack = 2.0 * (math.sqrt(0.5) + 1.0) * cell
        self._arm = max((robot.arm for robot in world.robots), default=0.0)
        self._node = np.cumsum(self.free.ravel()).reshape(self.free.shape) - 1
        self._graph = self._make_graph()

    def _make_graph(self) -> sparse.csr_matrix:
        """Edges between free cells, weighted in m."""
        count = int(self.free.sum())
        sources, targets, weights = [], [], []
        for down, right in STEPS:
            first, second = _shifted(self.free.shape, down, right)
            both = self.free[first] & self.free[second]
            sources.append(self._node[first][both])
            targets.append(self._node[second][both])
            weights.append(np.full(int(both.sum()), self.lattice.cell * math.hypot(down, right)))
        entries = (np.concatenate(weights), (np.concatenate(sources), np.concatenate(targets)))
        return sparse.csr_matrix(entries, shape=(count, count))

    def from_places(self, mask: np.ndarray) -> np.ndarray:
        """Least distance (rows, columns) in m that a sensor travels from the nearest cell of `mask` to each cell.

        Infinite where no sensor can get.
        """
        reached = np.full(self.free.shape, np.inf, dtype=np.float32)
        nodes = self._node[mask & self.free]
        if nodes.size:
            distance = csgraph.dijkstra(self._graph, directed=False, indices=nodes, min_only=True)
            reached[self.free] = np.maximum(distance / STRETCH - self._slack, 0.0)
        return self.carried(reached)

    def from_views(self, mask: np.ndarray) -> np.ndarray:
        """As `from_places`, from robots whose sensor is in a cell of `mask`."""
        return self.from_places(ndimage.binary_dilation(mask, self._disc()))

    def carried(self, distance: np.ndarray) -> np.ndarray:
        """Distances of the sensor from those of the robot's centre: the sensor is nowhere farther away than its arm."""
        return ndimage.grey_erosion(distance, footprint=self._disc(), mode="nearest")

    def _disc(self) -> np.ndarray:
        """Cells within the arm of the sensor."""
        reach = math.ceil(self._arm / self.lattice.cell)
        offsets = np.arange(-reach, reach + 1)
        return np.hypot(offsets[:, None], offsets) <= self._arm / self.lattice.cell + 0.5

    def from_start(self, start: Pose) -> np.ndarray:
        """As `from_places`, from one pose. Raises ValueError for one beside the world."""
        row, column = self.lattice.index(np.array(start[:2]))
        if not (0 <= row < self.free.shape[0] and 0 <= column < self.free.shape[1]):
            raise ValueError(f"({start[0]:g}, {start[1]:g}) lies outside the world")
        mask = np.zeros(self.free.shape, dtype=bool)
        mask[row, column] = True
        return self.from_places(mask)


class Views:
    """Parts of the lattice from which a cell of a map can be seen, by sensors that look all around."""

    def __init__(self, world: TrueWorld, lattice: Lattice) -> None:
        self.lattice = lattice
        self.range = world.range_max
        self._cast = world.cast
        self._angles = np.arange(BEAMS) * (2.0 * math.pi / BEAMS)
        self._directions = np.stack([np.cos(self._angles), np.sin(self._angles)], axis=1)
        # The cell of the map that holds a point may extend one cell to any side of it.
        self._offsets = MAP_CELL * np.array([(-1, -1), (-1, 1), (1, -1), (1, 1), (0, 0)])

    def of_point(self, point: np.ndarray) -> View:
        """Of a point (2,) in the world frame."""
        reach = math.ceil((self.range + 2.0 * MAP_CELL) / self.lattice.cell) + 1
        row, column = self.lattice.index(point)
        rows, columns = (
            slice(max(0, int(middle) - reach), min(size, int(middle) + reach + 1))
            for middle, size in zip((row, column), self.lattice.shape)
        )
        seen = np.zeros((rows.stop - rows.start, columns.stop - columns.start), dtype=np.uint8)
        corner = np.array([columns.start, rows.start])
        for begin in point + self._offsets:
            lengths = self._cast((begin[0], begin[1]), self._angles, self.range + 2.0 * MAP_CELL)
            ends = begin + self._directions * lengths[:, None]
            cv2.fillPoly(seen, [(self.lattice.index(ends)[:, ::-1] - corner).astype(np.int32)], 1)
        return View(rows, columns, np.packbits(seen))


def inscribed_radius(footprint: Sequence[Polygon]) -> float:
    """Radius in m of the largest disc around the origin that lies in one polygon of the footprint."""
    return max((_inscribed_in(np.array(polygon)) for polygon in footprint), default=0.0)


def _inscribed_in(corners: np.ndarray) -> float:
    edges = np.roll(corners, -1, axis=0) - corners
    along = np.clip(-(corners * edges).sum(axis=1) / (edges**2).sum(axis=1), 0.0, 1.0)
    nearest = np.hypot(*(corners + along[:, None] * edges).T).min()
    inside = cv2.pointPolygonTest(corners.astype(np.float32), (0.0, 0.0), False) > 0
    return float(nearest) if inside else 0.0


def _shifted(shape: tuple[int, int], down: int, right: int) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """Windows of an array that hold the beginnings and the ends of all steps of one kind."""
    rows, columns = shape
    first = slice(0, rows - down), slice(max(0, -right), columns - max(0, right))
    second = slice(down, rows), slice(max(0, right), columns - max(0, -right))
    return first, second
