"""Rigid transforms between paired points, which may be many fits at a time: sums over the pairs are all that they need.

Points are complex numbers. Least squares (Umeyama 1991, in the plane and without scale).
"""

from typing import NamedTuple, Tuple

import numpy as np

from mr_grid import Pose


class Moments(NamedTuple):
    """Sums over pairs of points source -> target; arrays of any shape, so sums of many sets of pairs are one value."""

    weight: np.ndarray
    source: np.ndarray
    target: np.ndarray
    source_square: np.ndarray
    target_square: np.ndarray
    product: np.ndarray

    def plus(self, other: "Moments") -> "Moments":
        """Of both sets together (broadcast)."""
        return Moments(*(mine + theirs for mine, theirs in zip(self, other)))


def moments_of(source: np.ndarray, target: np.ndarray, label: np.ndarray, labels: int) -> Moments:
    """Of each of the sets that `label` (int (n,), 0 <= label < labels) names; arrays (labels,)."""

    def total(values: np.ndarray) -> np.ndarray:
        if np.iscomplexobj(values):
            return total(values.real) + 1j * total(values.imag)
        return np.bincount(label, values, labels)

    return Moments(
        np.bincount(label, minlength=labels).astype(float),
        total(source),
        total(target),
        total(np.abs(source) ** 2),
        total(np.abs(target) ** 2),
        total(target * source.conjugate()),
    )


class Fits(NamedTuple):
    """turn: unit complex. shift: complex, m. error: root mean square distance, m. spread: root mean square distance of
    the source points from their mean, m."""

    turn: np.ndarray
    shift: np.ndarray
    error: np.ndarray
    spread: np.ndarray


def fits_of(moments: Moments) -> Fits:
    """The best transform of each set; sets without extent keep their rotation of 0."""
    count = np.maximum(moments.weight, 1.0)
    mean_source, mean_target = moments.source / count, moments.target / count
    product = moments.product - mean_target * moments.source.conjugate()
    length = np.abs(product)
    turn = np.where(length > 1e-9, product / np.maximum(length, 1e-9), 1.0 + 0j)
    square_source = np.maximum(moments.source_square / count - np.abs(mean_source) ** 2, 0.0)
    square_target = np.maximum(moments.target_square / count - np.abs(mean_target) ** 2, 0.0)
    error = np.sqrt(np.maximum(square_source + square_target - 2.0 * length / count, 0.0))
    return Fits(turn, mean_target - turn * mean_source, error, np.sqrt(square_source))


def fitted(source: np.ndarray, target: np.ndarray) -> Tuple[complex, complex]:
    """Turn and shift for one set of pairs."""
    mean_source, mean_target = source.mean(), target.mean()
    product = np.vdot(source - mean_source, target - mean_target)
    turn = complex(product / abs(product)) if abs(product) > 1e-9 else 1.0 + 0j
    return turn, complex(mean_target - turn * mean_source)


def transform_from(turn: complex, shift: complex) -> Pose:
    """As a value."""
    return Pose(shift.real, shift.imag, float(np.angle(turn)))


def covariance_of(source: np.ndarray, deviation: float) -> np.ndarray:
    """Covariance (3, 3) of x, y, yaw of a fit of pairs whose points have independent errors of `deviation` m in each
    direction, with the rotation about the mean of the source points."""
    spread = float((np.abs(source - source.mean()) ** 2).sum())
    return np.diag([deviation**2 / len(source)] * 2 + [deviation**2 / max(spread, 1e-9)])
