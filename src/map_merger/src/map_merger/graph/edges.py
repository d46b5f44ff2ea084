"""Transforms between two robots' frames as somebody found them, and what of it is believed to be no garbage."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple, Tuple

import numpy as np

from mr_grid import Pose

from ..covariance import Covariance
from ..messages import Boot

MOST_ROBOTS = 64
MOST_EDGES = MOST_ROBOTS - 1
"""Of one reporter: one to each other robot."""
FARTHEST_EDGE_M = 10_000.0
LONGEST_WALL_M = 100_000.0
LARGEST_DEVIATION_M = 5.0
LARGEST_DEVIATION_RAD = math.radians(45.0)
"""An edge with a larger standard deviation says nothing."""
SMALLEST_VARIANCE = 1e-12
ENOUGH_WALL_M = 40.0
"""More shared wall (m) makes an edge no more credible."""


class EdgeError(ValueError):
    """An edge that cannot be used, with the reason."""


@dataclass(frozen=True)
class Edge:
    """`transform` maps the frame of `target` to that of `reporter`, each in the run named.

    covariance: of the transform's x, y (m) and yaw (rad). shared_wall: m of wall in both maps. met: the robots saw one
    another where the transform says. age: s since the reporter last compared it with its maps, when it was told.
    """

    reporter: str
    target: str
    reporter_run: Boot
    target_run: Boot
    transform: Pose
    covariance: Covariance
    shared_wall: float = 0.0
    met: bool = False
    age: float = field(default=0.0, compare=False)

    @property
    def weight(self) -> float:
        """How much the edge counts against others, 1 to 1.75.

        It grows slowly: several robots that agree know more than one that is sure of itself.
        """
        return 1.0 + 0.5 * min(1.0, self.shared_wall / ENOUGH_WALL_M) + 0.25 * self.met

    @property
    def pair(self) -> Tuple[str, str]:
        """Both robots in the order of their names."""
        return (self.reporter, self.target) if self.reporter < self.target else (self.target, self.reporter)


class EdgeReport(NamedTuple):
    """All edges that a robot has found itself, in the run `boot`."""

    robot: str
    boot: Boot
    edges: Tuple[Edge, ...]


def check(edge: Edge) -> None:
    """EdgeError if the edge cannot be used."""
    fault = _fault(edge)
    if fault:
        raise EdgeError(f"transform {edge.reporter} - {edge.target}: {fault}")


def _fault(edge: Edge) -> str:
    if not edge.reporter or not edge.target or edge.reporter == edge.target:
        return "not between two robots"
    numbers = (*edge.transform, edge.shared_wall, edge.age, *(value for row in edge.covariance for value in row))
    if len(numbers) != 14 or not all(math.isfinite(value) for value in numbers):
        return "values that are missing or not finite"
    if math.hypot(edge.transform.x, edge.transform.y) > FARTHEST_EDGE_M:
        return f"frames more than {FARTHEST_EDGE_M:g} m apart"
    if not (0.0 <= edge.shared_wall <= LONGEST_WALL_M) or edge.age < 0.0:
        return "a shared wall or an age that cannot be"
    return _covariance_fault(np.array(edge.covariance))


def _covariance_fault(covariance: np.ndarray) -> str:
    if covariance.shape != (3, 3) or not np.allclose(covariance, covariance.T, rtol=1e-6, atol=1e-9):
        return "a covariance that is not symmetric"
    if np.linalg.eigvalsh(covariance)[0] < SMALLEST_VARIANCE:
        return "a covariance that is not positive definite"
    if math.hypot(*arm_to_walls(covariance[None])[0, :2, 2]) > FARTHEST_EDGE_M:
        return f"fixed by walls more than {FARTHEST_EDGE_M:g} m away"
    deviations = np.sqrt(np.diag(covariance_at_walls(covariance[None])[0]))
    if max(deviations[:2]) > LARGEST_DEVIATION_M or deviations[2] > LARGEST_DEVIATION_RAD:
        return f"known to {max(deviations[:2]):.1f} m and {math.degrees(deviations[2]):.0f} deg only"
    return ""


def arm_to_walls(covariances: np.ndarray) -> np.ndarray:
    """Matrices (n, 3, 3) that carry an error (x, y, yaw) at the walls that fixed the transforms to the origins.

    An error of the rotation turns about the shared walls, however far the origins are; the correlations of the
    covariances (n, 3, 3) tell where.
    """
    matrices = np.tile(np.eye(3), (len(covariances), 1, 1))
    matrices[:, :2, 2] = covariances[:, :2, 2] / covariances[:, 2, 2, None]
    return matrices


def covariance_at_walls(covariances: np.ndarray) -> np.ndarray:
    """The covariances (n, 3, 3) of the place of the shared walls instead of the frame's origin."""
    back = arm_to_walls(covariances)
    back[:, :2, 2] *= -1.0
    return back @ covariances @ np.swapaxes(back, 1, 2)
