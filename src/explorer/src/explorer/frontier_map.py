"""The frontier cells of a map, found anew only where the map has changed."""

import math
from typing import Optional

import numpy as np

from explorer import _kernels
from explorer.changes import changed_windows, grown, within
from explorer.grid import OccupancyMap

# Unknown islands smaller than this, in square metres, are gaps between laser beams, not places to go to.
SMALLEST_UNKNOWN_AREA = 0.04


class FrontierMap:
    """A frontier cell is free, has an unknown cell among its 8 neighbours and no occupied one. Unknown islands below
    `SMALLEST_UNKNOWN_AREA` make no frontier."""

    def __init__(self, occupancy: OccupancyMap, former: Optional["FrontierMap"] = None) -> None:
        """`former`: of any earlier map; only what has changed since is computed, the result is the same."""
        self.occupancy = occupancy
        self._smallest_unknown = max(1, int(SMALLEST_UNKNOWN_AREA / occupancy.info.resolution**2))
        windows = None
        if former is not None and former.occupancy.info == occupancy.info:
            windows = changed_windows(former.occupancy.cells, occupancy.cells)
        if former is None or windows is None:
            self._found = self._find(occupancy.cells)
            return
        self._found: np.ndarray = former._found.copy() if windows else former._found
        # No farther can a cell be from one on which it depends: at the other end of the longest of the small islands.
        reach = self._smallest_unknown + 1
        for window in windows:
            window = grown(window, reach, occupancy.cells.shape)
            outer = grown(window, reach, occupancy.cells.shape)
            self._found[window] = self._find(occupancy.cells[outer])[within(window, outer)]

    def of_length(self, least: float) -> np.ndarray:
        """(height, width) bool array of the frontier cells; connected frontiers shorter than `least` metres are noise."""
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
