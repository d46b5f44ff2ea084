"""Poses in the plane, (x, y, yaw) in metres and radians."""

import math
from typing import Tuple

import numpy as np

Pose = Tuple[float, float, float]


def normalized(angle: float) -> float:
    return math.remainder(angle, 2.0 * math.pi)


def compose(frame: Pose, pose: Pose) -> Pose:
    """`pose`, given in `frame`, in the frame that `frame` is given in."""
    cosine, sine = math.cos(frame[2]), math.sin(frame[2])
    return (
        frame[0] + cosine * pose[0] - sine * pose[1],
        frame[1] + sine * pose[0] + cosine * pose[1],
        normalized(frame[2] + pose[2]),
    )


def inverse(pose: Pose) -> Pose:
    cosine, sine = math.cos(pose[2]), math.sin(pose[2])
    return (-cosine * pose[0] - sine * pose[1], sine * pose[0] - cosine * pose[1], -pose[2])


def placed(points: np.ndarray, frame: Pose) -> np.ndarray:
    """Points (n, 2), given in `frame`, in the frame that `frame` is given in."""
    # As complex numbers: with columns of two numbers numpy takes several times as long.
    plane = _plane(points) * complex(math.cos(frame[2]), math.sin(frame[2]))
    plane += complex(frame[0], frame[1])
    return plane.view(float)


def seen_from(points: np.ndarray, frame: Pose) -> np.ndarray:
    """Points (n, 2) as seen from `frame`."""
    plane = _plane(points) - complex(frame[0], frame[1])
    plane *= complex(math.cos(frame[2]), -math.sin(frame[2]))
    return plane.view(float)


def _plane(points: np.ndarray) -> np.ndarray:
    """Points (n, 2) as complex numbers (n, 1)."""
    return np.ascontiguousarray(points, dtype=float).view(complex)


def interpolate(first: Pose, second: Pose, share: float) -> Pose:
    """On the straight line from `first` (share 0) to `second` (share 1)."""
    return (
        first[0] + share * (second[0] - first[0]),
        first[1] + share * (second[1] - first[1]),
        normalized(first[2] + share * normalized(second[2] - first[2])),
    )
