"""Rigid transforms in the plane (metres and radians, REP-103 axes)."""

import math
from dataclasses import dataclass
from typing import Sequence, Tuple

import numpy as np

FARTHEST_M = 100_000.0
"""Coordinates farther than this from a frame's origin can only be garbage."""


def wrap_angle(angle: float) -> float:
    """The same angle in (-pi, pi]."""
    wrapped = math.remainder(angle, 2.0 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped


@dataclass(frozen=True)
class Transform:
    """Pose of one frame in another: turn by `yaw` (rad), then shift by `x`, `y` (m)."""

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    def pose(self) -> Tuple[float, float, float]:
        """(x, y, yaw)."""
        return self.x, self.y, self.yaw

    def compose(self, other: "Transform") -> "Transform":
        """`self` after `other`: maps a point p to self(other(p))."""
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        return Transform(
            self.x + cosine * other.x - sine * other.y,
            self.y + sine * other.x + cosine * other.y,
            wrap_angle(self.yaw + other.yaw),
        )

    def inverse(self) -> "Transform":
        """The transform that undoes this one."""
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        return Transform(-cosine * self.x - sine * self.y, sine * self.x - cosine * self.y, wrap_angle(-self.yaw))

    def apply(self, points: np.ndarray) -> np.ndarray:
        """Points of shape (n, 2) in metres, transformed."""
        # As complex numbers, for which numpy needs a fraction of the time of a product with a matrix of 2 x 2.
        plane = np.ascontiguousarray(points, float).view(complex)
        moved = plane * complex(math.cos(self.yaw), math.sin(self.yaw))
        moved += complex(self.x, self.y)
        return moved.view(float)

    def apply_point(self, x: float, y: float) -> Tuple[float, float]:
        """One point in metres, transformed."""
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        return self.x + cosine * x - sine * y, self.y + sine * x + cosine * y


def displacement(first: Transform, second: Transform, points: np.ndarray) -> np.ndarray:
    """Distance in metres, shape (n,), by which the two transforms place each of `points` (n, 2) differently."""
    return np.hypot(*(first.apply(points) - second.apply(points)).T)


def rotation_between(first: Transform, second: Transform) -> float:
    """Absolute difference of the headings in radians, in [0, pi]."""
    return abs(wrap_angle(first.yaw - second.yaw))


def transform_of(values: Sequence[float]) -> Transform:
    """Transform from `[x, y, yaw]`; ValueError if there are not three finite numbers."""
    numbers = [float(value) for value in values]
    if len(numbers) != 3 or not all(math.isfinite(number) for number in numbers):
        raise ValueError(f"a pose is [x, y, yaw] in metres and radians, not {list(values)!r}")
    return Transform(numbers[0], numbers[1], wrap_angle(numbers[2]))
