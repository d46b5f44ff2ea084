"""Poses in the plane, in metres and radians (REP-103 axes)."""

import math
from typing import NamedTuple, Sequence, Tuple

import numpy as np

FARTHEST = 1e5
"""m: farther than this from the origin of its frame nothing is. Larger coordinates are mistakes or forged, and
arithmetic on cells and places goes wrong with them."""


def is_place(*coordinates: float) -> bool:
    """Whether coordinates in metres are numbers of a usable size."""
    # Asked of every position that is heard: `all` of a generator takes three times as long.
    for value in coordinates:  # noqa: SIM110
        if not abs(value) <= FARTHEST:
            return False
    return True


def normalized(angle: float) -> float:
    """The same angle in (-pi, pi]."""
    wrapped = math.remainder(angle, 2.0 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped


class Pose(NamedTuple):
    """A pose in a frame, or that frame's transform: turn by `yaw` (rad), then shift by `x`, `y` (m).

    A tuple, because kernels in C++ take and give poses as such, and in loops one is made many thousand times.
    """

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    def compose(self, pose: "Pose") -> "Pose":
        """`pose`, given in this one as frame, in the frame that this one is given in."""
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        return Pose(
            self.x + cosine * pose.x - sine * pose.y,
            self.y + sine * pose.x + cosine * pose.y,
            normalized(self.yaw + pose.yaw),
        )

    def inverse(self) -> "Pose":
        """The frame that this pose is given in, as seen from it."""
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        return Pose(-cosine * self.x - sine * self.y, sine * self.x - cosine * self.y, normalized(-self.yaw))

    def between(self, pose: "Pose") -> "Pose":
        """`pose`, given in the same frame, as seen from this one."""
        return self.inverse().compose(pose)

    def interpolate(self, pose: "Pose", share: float) -> "Pose":
        """On the straight line from this pose (share 0) to another (share 1), turning the shorter way."""
        return Pose(
            self.x + share * (pose.x - self.x),
            self.y + share * (pose.y - self.y),
            normalized(self.yaw + share * normalized(pose.yaw - self.yaw)),
        )

    def apply(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 2) in metres, given in this frame, in the frame that this pose is given in."""
        # As complex numbers: with columns of two numbers or a product with a matrix numpy takes several times as long.
        plane = _plane(points) * complex(math.cos(self.yaw), math.sin(self.yaw))
        plane += complex(self.x, self.y)
        return plane.view(float)

    def apply_inverse(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 2) in metres as seen from this pose: what `apply` makes, undone."""
        plane = _plane(points) - complex(self.x, self.y)
        plane *= complex(math.cos(self.yaw), -math.sin(self.yaw))
        return plane.view(float)

    def apply_point(self, x: float, y: float) -> Tuple[float, float]:
        """`apply` for one point in metres."""
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        return self.x + cosine * x - sine * y, self.y + sine * x + cosine * y


IDENTITY = Pose()


def pose_of(values: Sequence[float]) -> Pose:
    """Pose from `[x, y, yaw]`; ValueError if there are not three finite numbers."""
    numbers = [float(value) for value in values]
    if len(numbers) != 3 or not all(math.isfinite(number) for number in numbers):
        raise ValueError(f"a pose is [x, y, yaw] in metres and radians, not {list(values)!r}")
    return Pose(numbers[0], numbers[1], normalized(numbers[2]))


def _plane(points: np.ndarray) -> np.ndarray:
    """Points (n, 2) as complex numbers (n, 1)."""
    return np.ascontiguousarray(points, dtype=float).view(complex)
