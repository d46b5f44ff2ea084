"""What a map shows of other robots: small isolated obstacles where they stand, which are no part of the building."""

from typing import Sequence, Tuple

import numpy as np

from mr_grid import GridInfo
from mr_grid.imaging import parts_of

# From the centre of the largest robot of the team to its farthest corner, in metres, unless a parameter says otherwise.
LARGEST_ROBOT_RADIUS = 0.29


def reach_of(radius: float) -> float:
    """The middle of what a laser saw of a robot of that radius lies this near to the robot's reported position; all in
    metres."""
    return round(radius + 0.16, 3)


def extent_of(radius: float) -> float:
    """Obstacles larger than this, with all that touches them, are walls, however near a robot of that radius is to
    them; in metres."""
    return round(2.0 * radius + 0.22, 3)


def robot_traces(
    occupied: np.ndarray,
    info: GridInfo,
    places: Sequence[Tuple[float, float]],
    radius: float = LARGEST_ROBOT_RADIUS,
) -> np.ndarray:
    """(height, width) bool array: which occupied cells are robots, of that radius at most, at these places; all in
    metres. `mr_sim` has the same rule in its planner."""
    near, most = reach_of(radius), extent_of(radius)
    traces = np.zeros(occupied.shape, dtype=bool)
    # An obstacle that is small and near enough lies wholly in the window, so one cut off at its edge is never taken.
    reach = int((near + most) / info.resolution) + 2
    for x, y in places:
        row, col = info.cell_of(x, y)
        top, left = max(0, row - reach), max(0, col - reach)
        window = np.s_[top : max(0, row + reach + 1), left : max(0, col + reach + 1)]
        if not occupied[window].any():
            continue
        parts = parts_of(occupied[window])
        gaps = np.hypot(*(info.centres_of(parts.middles[:, ::-1] + (top, left)) - (x, y)).T)
        robots = (parts.extents() * info.resolution <= most + 1e-9) & (gaps <= near)
        robots[0] = False  # the ground between the obstacles
        traces[window] |= robots[parts.labels]
    return traces
