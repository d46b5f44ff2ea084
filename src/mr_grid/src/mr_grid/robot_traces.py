"""What a map shows of other robots: small isolated obstacles where they stand, which are no part of the building."""

from typing import Sequence, Tuple

import numpy as np

from mr_grid import _imaging
from mr_grid.grid import FREE, OccupancyGrid


def reach_of(radius: float) -> float:
    """The middle of what a laser saw of a robot of that radius lies this near to the robot's reported position; all in
    metres."""
    return round(radius + 0.16, 3)


def extent_of(radius: float) -> float:
    """Obstacles larger than this, with all that touches them, are walls, however near a robot of that radius is to
    them; in metres."""
    return round(2.0 * radius + 0.22, 3)


def robot_traces(
    grid: OccupancyGrid, places: Sequence[Tuple[float, float]], radius: float, occupied_from: int
) -> np.ndarray:
    """Cells (row, column), int64 (n, 2), of robots, of that radius at most, at these places; all in metres. The grid is
    not turned. `occupied_from`: the least value of an obstacle."""
    near, largest, origin = reach_of(radius), extent_of(radius), (grid.origin.x, grid.origin.y)
    return _imaging.robot_traces(grid.cells, occupied_from, grid.resolution, origin, places, near, largest)


def cells_without_robots(
    grid: OccupancyGrid, places: Sequence[Tuple[float, float]], radius: float, occupied_from: int
) -> np.ndarray:
    """The grid's cells, free where they show robots as in `robot_traces`; themselves where they show none."""
    traces = robot_traces(grid, places, radius, occupied_from)
    if not len(traces):
        return grid.cells
    cells = grid.cells.copy()
    cells[traces[:, 0], traces[:, 1]] = FREE
    return cells
