"""Registration by image features: the paper's method with the successor of its OpenCV call, verified like the default.

ORB key points of both maps are matched and a similarity transform is estimated by RANSAC (`estimateAffinePartial2D`
took the place of `estimateRigidTransform`). On repeated rooms it proposes wrong transforms; the verification then
declines.
"""

import math
from typing import List, NamedTuple, Optional, Tuple

import cv2
import numpy as np

from mr_grid import OccupancyGrid, Pose
from mr_grid.map_files import image_of

from .registration import DEFAULT_CRITERIA, UNLIMITED, Criteria, Limits, Registration, choose
from .search import Prior
from .surface import Landmarks

_SCALE_TOLERANCE = 0.05
_ROUNDS = 4


def register(
    target: Landmarks,
    source: Landmarks,
    criteria: Criteria = DEFAULT_CRITERIA,
    limits: Limits = UNLIMITED,
    prior: Optional[Prior] = None,
) -> Registration:
    """Finds the transform source -> target from ORB features, or declines."""
    return choose(target, source, estimates(target.grid, source.grid, orb(), _ROUNDS), (criteria,), limits, prior)


class Detector(NamedTuple):
    """An OpenCV feature detector, and the largest Hamming distance of descriptors that may be the same."""

    features: cv2.Feature2D
    largest_distance: float


def orb() -> Detector:
    """ORB (Rublee et al. 2011)."""
    return Detector(cv2.ORB_create(nfeatures=1500, fastThreshold=5), 60.0)


def akaze() -> Detector:
    """AKAZE (Alcantarilla et al. 2013)."""
    return Detector(cv2.AKAZE_create(threshold=0.0005), 120.0)


def estimates(target: OccupancyGrid, source: OccupancyGrid, detector: Detector, most: int) -> List[Pose]:
    """At most `most` transforms source -> target, each from the matches that the earlier ones left over; those with a
    scale near 1."""
    here, there = _matches(target, source, detector)
    found: List[Pose] = []
    for _ in range(most):
        if len(here) < 4:
            break
        matrix, inliers = cv2.estimateAffinePartial2D(here, there, ransacReprojThreshold=0.2, maxIters=4000)
        if matrix is None:
            break
        if abs(math.hypot(matrix[0, 0], matrix[1, 0]) - 1.0) <= _SCALE_TOLERANCE:
            found.append(Pose(float(matrix[0, 2]), float(matrix[1, 2]), math.atan2(matrix[1, 0], matrix[0, 0])))
        outside = inliers.ravel() == 0
        here, there = here[outside], there[outside]
    return found


def _matches(target: OccupancyGrid, source: OccupancyGrid, detector: Detector) -> Tuple[np.ndarray, np.ndarray]:
    """Places (n, 2; m) in the source and in the target of key points that are each other's best match."""
    target_keys, target_descriptors = detector.features.detectAndCompute(image_of(target), None)
    source_keys, source_descriptors = detector.features.detectAndCompute(image_of(source), None)
    if target_descriptors is None or source_descriptors is None:
        return np.empty((0, 2)), np.empty((0, 2))
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(source_descriptors, target_descriptors)
    matches = [match for match in matches if match.distance <= detector.largest_distance]
    here = _points(source, [source_keys[match.queryIdx].pt for match in matches])
    return here, _points(target, [target_keys[match.trainIdx].pt for match in matches])


def _points(grid: OccupancyGrid, pixels: list) -> np.ndarray:
    positions = np.array(pixels, dtype=float).reshape(-1, 2)
    return grid.info.centres(positions[:, 1], positions[:, 0])
