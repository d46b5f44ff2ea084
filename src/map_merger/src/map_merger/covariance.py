"""How well the shared walls fix a transform."""

import math
from typing import Optional, Tuple

import numpy as np

from mr_grid import Pose

from .evidence import comparison_of, match_tolerance
from .search import Prior
from .surface import Landmarks

Covariance = Tuple[Tuple[float, float, float], Tuple[float, float, float], Tuple[float, float, float]]
"""Of the x, y (m) and yaw (rad) of a transform."""

_SMALLEST_ERROR_M = 0.02
_INDEPENDENT_M = 0.25
"""Metres of wall that make one independent measurement: the errors of neighbouring cells have the same cause."""
_DRIFT_M = 0.03
_DRIFT_RAD = math.radians(0.3)
"""Both maps are bent a little; that the walls fit does not tell by how much."""
_LOOSE_M = 2.0
_LOOSE_RAD = math.radians(20.0)
"""Standard deviation of what the shared walls leave open, as the shift along a corridor."""


def covariance_of(target: Landmarks, source: Landmarks, transform: Pose) -> Covariance:
    """Covariance of the `transform` source -> target that refinement has found.

    The information of the distances from point to line (Censi, "An accurate closed-form estimate of ICP's covariance",
    2007, without the term of the second order) with a standard deviation of half a cell, at least 0.02 m and at least
    what remained. To it comes what drift may have done to the maps, about the middle of the shared walls.
    """
    found = comparison_of(target, source.surface, transform, match_tolerance(target, source))
    cell = max(target.info.resolution, source.info.resolution)
    variance = max(_SMALLEST_ERROR_M, 0.5 * cell, math.sqrt(found.mean_square)) ** 2
    share = min(1.0, source.surface.spacing / _INDEPENDENT_M)
    arm = np.eye(3)
    if found.matched:
        # A turn about the middle of the walls moves the origin of the source.
        arm[0, 2], arm[1, 2] = found.middle[1] - transform.y, transform.x - found.middle[0]
    information = share / variance * (arm.T @ np.array(found.information) @ arm)
    information += np.diag([_LOOSE_M**-2, _LOOSE_M**-2, _LOOSE_RAD**-2])
    at_walls = np.linalg.inv(information) + np.diag([_DRIFT_M**2, _DRIFT_M**2, _DRIFT_RAD**2])
    return as_covariance(arm @ at_walls @ arm.T)


def covariance_at_origin(transform: Pose, covariance: np.ndarray, centre: Tuple[float, float]) -> Covariance:
    """The covariance (3, 3) of x, y (m) and yaw (rad) of the transform, given with the rotation about `centre`, a point
    of the source's frame (m)."""
    x, y = transform.apply_point(*centre)
    arm = np.eye(3)
    arm[0, 2], arm[1, 2] = y - transform.y, transform.x - x
    return as_covariance(arm @ covariance @ arm.T)


def as_covariance(matrix: np.ndarray) -> Covariance:
    """The matrix (3, 3) as a value, made symmetric."""
    (a, b, c), (_, d, e), (_, _, f) = (0.5 * (matrix + matrix.T)).tolist()
    return (a, b, c), (b, d, e), (c, e, f)


def prior_from(transform: Pose, covariance: Covariance, place: Optional[Tuple[float, float]] = None) -> Prior:
    """Where to search for a transform that is known roughly: within three standard deviations, at least 1 m and 8 deg.

    place: of the source's map (m, in its frame), where the distance counts; its origin if not given.
    """
    matrix = np.array(covariance)
    x, y = transform.apply_point(*place) if place is not None else (transform.x, transform.y)
    to_place = np.eye(3)
    to_place[0, 2], to_place[1, 2] = transform.y - y, x - transform.x
    there = to_place @ matrix @ to_place.T
    return Prior(
        transform,
        min(3.0, max(1.0, 3.0 * math.sqrt(np.linalg.eigvalsh(there[:2, :2])[-1]))),
        min(math.radians(30.0), max(math.radians(8.0), 3.0 * math.sqrt(matrix[2, 2]))),
    )
