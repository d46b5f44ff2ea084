"""The frontier cells of a map, found anew only where the map has changed."""

import math
from typing import Optional, Sequence

import numpy as np

from explorer import _kernels
from explorer.changes import Window, changed_windows, grown, within
from explorer.grid import OccupancyMap

# Unknown islands smaller than this, in square metres, are gaps between laser beams, not places to go to.
SMALLEST_UNKNOWN_AREA = 0.04


class FrontierMap:
    """A frontier cell is free, has an unknown cell among its 8 neighbours and no occupied one. Unknown islands below
    `SMALLEST_UNKNOWN_AREA` make no frontier."""

    def __init__(
        self, occupancy: OccupancyMap, former: Optional["FrontierMap"] = None, changed: Sequence[Window] = ()
    ) -> None:
        """`changed`: where the map differs from the former one. See `of`."""
        self.occupancy = occupancy
        self._smallest_unknown = max(1, int(SMALLEST_UNKNOWN_AREA / occupancy.info.resolution**2))
        cells = occupancy.cells
        self._found: np.ndarray = self._find(cells) if former is None else former._found.copy()
        # No farther can a cell be from one on which it depends: at the other end of the longest of the small islands.
        reach = self._smallest_unknown + 1
        for window in changed:
            window = grown(window, reach, cells.shape)
            outer = grown(window, reach, cells.shape)
            self._found[window] = self._find(cells[outer])[within(window, outer)]

    @classmethod
    def of(cls, occupancy: OccupancyMap, former: Optional["FrontierMap"]) -> "FrontierMap":
        """`former`: of any earlier map; only what has changed since is computed, and without a change it is returned
        itself."""
        changed = None
        if former is not None and former.occupancy.info == occupancy.info:
            changed = changed_windows(former.occupancy.cells, occupancy.cells)
        if former is None or changed is None:
            return cls(occupancy)
        return cls(occupancy, former, changed) if changed else former

    def of_length(self, least: float) -> np.ndarray:
        """(height, width) bool array of the frontier cells, without connected frontiers shorter than `least` metres."""
        cells = np.flatnonzero(self._found)
        count = _cells_of_length(least, self.occupancy.info.resolution)
        long_enough = np.zeros(self._found.shape, dtype=bool)
        long_enough.ravel()[cells[_kernels.large_frontiers(cells, self._found.shape[1], count)]] = True
        return long_enough

    def _find(self, cells: np.ndarray) -> np.ndarray:
        return _kernels.frontier_cells(
            cells, OccupancyMap.FREE_BELOW, OccupancyMap.OCCUPIED_FROM, self._smallest_unknown, 0
        )


def frontier_cells(occupancy: OccupancyMap, least: float) -> np.ndarray:
    """(height, width) bool array of the frontier cells of a map, see `FrontierMap`, that belong to frontiers of at
    least `least` metres."""
    return FrontierMap(occupancy).of_length(least)


def _cells_of_length(length: float, resolution: float) -> int:
    """The least number of cells that are at least as long, both in metres."""
    count = max(0, math.floor(length / resolution) - 1)
    while count * resolution < length:
        count += 1
    return count
