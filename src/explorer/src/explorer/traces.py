"""What a map shows of other robots: small isolated obstacles where they stand, which are no part of the building."""

from typing import Sequence, Tuple

import cv2
import numpy as np

from explorer.grid import GridInfo

# The middle of what a laser saw of a robot lies this near to the robot's reported position, in metres.
ROBOT_REACH = 0.45

# Obstacles larger than this in metres, with all that touches them, are walls, however near a robot is to them.
ROBOT_EXTENT = 0.8


def robot_traces(occupied: np.ndarray, info: GridInfo, places: Sequence[Tuple[float, float]]) -> np.ndarray:
    """(height, width) bool array: which occupied cells are robots at these places in metres. `mr_sim` has the same
    rule in its planner."""
    traces = np.zeros(occupied.shape, dtype=bool)
    # An obstacle that is small and near enough lies wholly in the window, so one cut off at its edge is never taken.
    reach = int((ROBOT_REACH + ROBOT_EXTENT) / info.resolution) + 2
    for x, y in places:
        row, col = info.cell_of(x, y)
        top, left = max(0, row - reach), max(0, col - reach)
        window = np.s_[top : max(0, row + reach + 1), left : max(0, col + reach + 1)]
        if not occupied[window].any():
            continue
        _, labels, statistics, middles = cv2.connectedComponentsWithStats(
            occupied[window].astype(np.uint8), connectivity=8
        )
        extent = np.maximum(statistics[:, cv2.CC_STAT_WIDTH], statistics[:, cv2.CC_STAT_HEIGHT]) * info.resolution
        gaps = np.hypot(*(info.centres_of(middles[:, ::-1] + (top, left)) - (x, y)).T)
        robots = (extent <= ROBOT_EXTENT + 1e-9) & (gaps <= ROBOT_REACH)
        robots[0] = False  # the ground between the obstacles
        traces[window] |= robots[labels]
    return traces
