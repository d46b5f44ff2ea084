"""Connected obstacles of a map."""

from typing import NamedTuple

import cv2
import numpy as np


class Obstacles(NamedTuple):
    """Connected obstacles (8 neighbours), numbered from 1; 0 is all the rest.

    labels: int32 (rows, columns). statistics: int32 (n, 5), columns cv2.CC_STAT_*. centres: float64 (n, 2), column and
    row.
    """

    labels: np.ndarray
    statistics: np.ndarray
    centres: np.ndarray

    def extents(self) -> np.ndarray:
        """Larger side of the box around each, in cells, (n,)."""
        return np.maximum(self.statistics[:, cv2.CC_STAT_WIDTH], self.statistics[:, cv2.CC_STAT_HEIGHT])


def obstacles_of(occupied: np.ndarray) -> Obstacles:
    """The connected obstacles of a map, bool (rows, columns)."""
    if not occupied.size:  # OpenCV crashes on it
        return Obstacles(np.zeros(occupied.shape, np.int32), np.zeros((1, 5), np.int32), np.zeros((1, 2)))
    _, *found = cv2.connectedComponentsWithStats(occupied.view(np.uint8), connectivity=8)
    return Obstacles(*found)
