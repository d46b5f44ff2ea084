"""Maps as the engines have them, as the measures take them."""

from __future__ import annotations

import numpy as np

from map_merger.grid import Grid
from mr_grid import OccupancyGrid, Pose
from mr_sim.measures import OccupancyMap


def free_area(cells: np.ndarray, resolution: float) -> float:
    """m^2 of explored free space."""
    return float(np.count_nonzero((cells >= 0) & (cells < 50))) * resolution * resolution


def grid_as_map(grid: Grid) -> OccupancyMap:
    origin = grid.info.origin
    return OccupancyMap(grid.cells, grid.info.resolution, Pose(origin.x, origin.y, origin.yaw))


def occupancy_of(local: OccupancyGrid | None) -> OccupancyMap:
    """Without cells where there is no map yet."""
    if local is None:
        return OccupancyMap(np.zeros((0, 0), dtype=np.int8), 1.0)
    return OccupancyMap(local.cells, local.resolution, local.origin)
