"""Objects of a robot's size in a map, for robots without a laser topic."""

import numpy as np

from mr_grid import OccupancyGrid, Pose

from ..grid import occupied_cells
from ..obstacles import obstacles_of
from .detection import NARROWEST_M


def objects_in_map(grid: OccupancyGrid, viewer: Pose, reach: float, widest: float) -> np.ndarray:
    """Centres (n, 2), m, in the map's frame, of small isolated obstacles, at most `widest` m across, within `reach` m
    of the viewer."""
    obstacles = obstacles_of(occupied_cells(grid))
    extents = obstacles.extents() * grid.info.resolution
    fits = (obstacles.areas >= 2) & (extents >= NARROWEST_M) & (extents <= widest)
    # A centre is that of cells, which `cell_centres` counts from their middle.
    centres = grid.info.centres(obstacles.centres[fits, 0], obstacles.centres[fits, 1])
    return centres[np.hypot(centres[:, 0] - viewer.x, centres[:, 1] - viewer.y) <= reach]
