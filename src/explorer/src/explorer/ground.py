"""What the cells of a map are to a robot of a certain radius: obstacles, where its centre can be, where it might be."""

import math
from typing import Dict, NamedTuple, Optional, Sequence

import numpy as np

from explorer._kernels import cells_near, distances_to, pooled_maximum
from explorer.changes import Window, aligned, blocks, changed_windows, grown, within
from explorer.geometry import Position
from explorer.grid import OccupancyMap
from mr_grid import FREE
from mr_grid.robot_traces import cells_without_robots

# A comfortable place is this much farther from unknown cells than a robot has to be from obstacles, in metres.
UNKNOWN_ROOM = 0.05

# Clearance beyond the robot's radius and this, in metres, makes no difference and is told as this much, so that changes
# have no effects afar.
MOST_ROOM = 0.45


class Layers(NamedTuple):
    """bool arrays of the cells of a map. `occupied`: the obstacles without other robots. `fits`: these keep the radius
    from the robot's centre. `allowed`: that fits and is known to be free. `enterable`: it fits and is free or
    unknown."""

    occupied: np.ndarray
    fits: np.ndarray
    allowed: np.ndarray
    enterable: np.ndarray


class Pools(NamedTuple):
    """On a grid that is coarser by a factor. `clearance`: float32, m, the greatest of a cell's allowed fine cells, -1
    without one; `away`: bool, one of them is away from the unknown."""

    clearance: np.ndarray
    away: np.ndarray


class _Part(NamedTuple):
    """A window of a map: its layers, and as arrays of its shape `clearance`, float32 in m, and where it is `away` from
    the unknown, bool."""

    layers: Layers
    clearance: np.ndarray
    away: np.ndarray

    def cut(self, window: Window) -> "_Part":
        return _Part(Layers(*(layer[window] for layer in self.layers)), self.clearance[window], self.away[window])

    def pooled(self, factor: int) -> Pools:
        clearance = pooled_maximum(self.clearance, self.layers.allowed, factor)
        return Pools(clearance, pooled_maximum(self.clearance, self.layers.allowed & self.away, factor) >= 0)


class Ground:
    """The layers of one map, and its pools by factor, each computed when it is first asked for."""

    def __init__(
        self,
        occupancy: OccupancyMap,
        radius: float,
        cells: np.ndarray,
        former: Optional["Ground"] = None,
        changed: Sequence[Window] = (),
    ) -> None:
        """`cells`: of the map without robots. `changed`: where they differ from those of the former one. See `of`."""
        self.occupancy, self.radius, self._cells = occupancy, radius, cells
        self._limit = radius + max(MOST_ROOM, occupancy.info.resolution)
        self._reach = math.ceil(self._limit / occupancy.info.resolution) + 1
        self._whole: Optional[_Part] = None
        self._pools: Dict[int, Pools] = {}
        if former is None:
            self._whole = self._part((slice(0, cells.shape[0]), slice(0, cells.shape[1])))
            self.layers = self._whole.layers
        else:
            self._follow(former, changed)
        self.count = int(np.count_nonzero(self.layers.allowed))

    @classmethod
    def of(
        cls,
        occupancy: OccupancyMap,
        radius: float,
        robots: Sequence[Position],
        largest: float,
        former: Optional["Ground"] = None,
    ) -> "Ground":
        """`robots`: places of the others in metres; the small isolated obstacles that the map shows there are taken for
        them. `largest`: radius of the largest robot of the team in metres, to its farthest corner. `former`: of any
        earlier map; only what has changed since is computed, and without a change it is returned itself."""
        cells = cells_without_robots(occupancy, robots, largest, OccupancyMap.OCCUPIED_FROM)
        changed = None
        if former is not None and (former.radius, former.occupancy.info) == (radius, occupancy.info):
            changed = changed_windows(former._cells, cells)
        if former is None or changed is None:
            return cls(occupancy, radius, cells)
        return cls(occupancy, radius, cells, former, changed) if changed else former

    def pools(self, factor: int) -> Pools:
        if factor not in self._pools:
            if self._whole is None:
                self._whole = self._part((slice(0, self._cells.shape[0]), slice(0, self._cells.shape[1])))
            self._pools[factor] = self._whole.pooled(factor)
        return self._pools[factor]

    def _follow(self, former: "Ground", changed: Sequence[Window]) -> None:
        self.layers = Layers(*(layer.copy() for layer in former.layers))
        self._pools = {factor: Pools(*(pool.copy() for pool in pools)) for factor, pools in former._pools.items()}
        edge = int(np.lcm.reduce([1, *self._pools]))
        for window in changed:
            window = aligned(grown(window, self._reach, self._cells.shape), edge, self._cells.shape)
            part = self._part(window)
            for layer, new in zip(self.layers, part.layers):
                layer[window] = new
            for factor, pools in self._pools.items():
                for pool, new in zip(pools, part.pooled(factor)):
                    pool[blocks(window, factor)] = new

    def _part(self, window: Window) -> _Part:
        outer = grown(window, self._reach, self._cells.shape)
        cells, resolution = self._cells[outer], self.occupancy.info.resolution
        occupied, unknown = cells >= OccupancyMap.OCCUPIED_FROM, cells < FREE
        if occupied.any():
            clearance = np.minimum(distances_to(occupied, resolution), np.float32(self._limit))
        else:
            clearance = np.full(cells.shape, self._limit, dtype=np.float32)
        fits = clearance >= self.radius
        allowed = fits & ~unknown & (cells < OccupancyMap.FREE_BELOW)
        layers = Layers(occupied, fits, allowed, allowed | (fits & unknown))
        part = _Part(layers, clearance, ~cells_near(unknown, resolution, self.radius + UNKNOWN_ROOM))
        return part.cut(within(window, outer))
