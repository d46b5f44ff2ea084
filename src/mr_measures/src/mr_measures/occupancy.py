"""Maps as the engines have them, as the measures take them."""

from __future__ import annotations

import numpy as np

from mr_grid import GridInfo, OccupancyGrid, empty_grid
from mr_measures.figures import FREE_BELOW


def free_area(cells: np.ndarray, resolution: float) -> float:
    """m^2 of explored free space."""
    # Read without a sign, unknown cells are above all others.
    return float(np.count_nonzero(cells.view(np.uint8) < FREE_BELOW)) * resolution * resolution


def occupancy_of(local: OccupancyGrid | None) -> OccupancyGrid:
    """Without cells where there is no map yet."""
    return empty_grid(GridInfo(0, 0, 1.0)) if local is None else local
