"""How far apart two transforms are (metres and radians, REP-103 axes)."""

import numpy as np

from mr_grid import Pose, normalized


def displacement(first: Pose, second: Pose, points: np.ndarray) -> np.ndarray:
    """Distance in metres, shape (n,), by which the two transforms place each of `points` (n, 2) differently."""
    return np.hypot(*(first.apply(points) - second.apply(points)).T)


def rotation_between(first: Pose, second: Pose) -> float:
    """Absolute difference of the headings in radians, in [0, pi]."""
    return abs(normalized(first.yaw - second.yaw))
