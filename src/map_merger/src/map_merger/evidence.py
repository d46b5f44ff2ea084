"""What speaks for and against a transform between two maps."""

import math
from dataclasses import dataclass

import numpy as np

from .grid import values_at
from .surface import NORMAL_WEIGHT, Landmarks, Surface
from .transform import Transform

_NORMAL_TOLERANCE = math.cos(math.radians(30.0))


@dataclass(frozen=True)
class Evidence:
    """Agreement of two maps under a transform. Lengths in metres of wall, the smaller of both directions of comparison.

    matched: walls found in both. minor: matched length in the weaker direction (smaller eigenvalue of the normals'
    scatter). conflict: share of matched plus contradicted walls that lie in well observed free space of the other map
    (the larger of both directions). explained: share of one map's walls inside the known part of the other that are
    matched (the smaller). error: root mean square distance of the matched walls in metres. against: walls of one map in
    well observed free space of the other (the larger).
    """

    matched: float = 0.0
    minor: float = 0.0
    conflict: float = 1.0
    explained: float = 0.0
    error: float = math.inf
    against: float = 0.0

    @property
    def score(self) -> float:
        """One number to rank transforms: agreed wall, steeply reduced by contradictions.

        Rooms laid on the wrong room agree in long walls and contradict each other in a tenth to a fifth of them; true
        transforms of undistorted maps contradict each other in next to nothing.
        """
        return self.matched * max(0.0, 1.0 - 6.0 * self.conflict) * self.explained


def moved_surface(surface: Surface, transform: Transform) -> Surface:
    """The surface in the frame into which `transform` maps."""
    return Surface(
        transform.apply(surface.points), surface.normals @ transform.rotation().T, surface.spacing, surface.solid
    )


def compare(target: Landmarks, source: Landmarks, transform: Transform) -> Evidence:
    """Evidence for `transform` (source -> target)."""
    if not len(target.surface.points) or not len(source.surface.points):
        return Evidence()
    tolerance = match_tolerance(target, source)
    forward = _one_way(target, moved_surface(source.surface, transform), tolerance)
    backward = _one_way(source, moved_surface(target.surface, transform.inverse()), tolerance)
    return Evidence(
        matched=min(forward.matched, backward.matched),
        minor=min(forward.minor, backward.minor),
        conflict=max(forward.conflict, backward.conflict),
        explained=min(forward.explained, backward.explained),
        error=max(forward.error, backward.error),
        against=max(forward.against, backward.against),
    )


def match_tolerance(target: Landmarks, source: Landmarks) -> float:
    """Distance in metres up to which two surface points are the same wall: two cells, at least 0.1 m."""
    return max(0.1, 2.0 * max(target.info.resolution, source.info.resolution))


def nearest(target: Surface, moved: Surface, reach: float) -> tuple:
    """For each point of `moved` the index of the nearest like-facing point of `target`, and whether it is within
    `reach`."""
    index = target.index().nearest(moved.points, moved.normals, math.hypot(reach, NORMAL_WEIGHT * 0.52))
    hit = index >= 0
    index = np.maximum(index, 0)
    gap = np.hypot(*(moved.points - target.points[index]).T)
    facing = np.einsum("ij,ij->i", moved.normals, target.normals[index])
    return index, hit & (gap <= reach) & (facing >= _NORMAL_TOLERANCE)


def _one_way(target: Landmarks, moved: Surface, tolerance: float) -> Evidence:
    clear = values_at(target.clear, target.info, moved.points, False)
    known = values_at(target.known, target.info, moved.points, False)
    inside = np.flatnonzero(known)
    if inside.size == 0:
        return Evidence()
    part = Surface(moved.points[inside], moved.normals[inside], moved.spacing, moved.solid[inside])
    index, matched = nearest(target.surface, part, tolerance)
    contradicted = int((clear[inside] & ~matched & part.solid).sum())
    count = int(matched.sum())
    if count == 0:
        return Evidence(against=contradicted * moved.spacing)
    normals = part.normals[matched]
    scatter = normals.T @ normals
    residual = np.einsum(
        "ij,ij->i", part.points[matched] - target.surface.points[index[matched]], target.surface.normals[index[matched]]
    )
    return Evidence(
        matched=count * moved.spacing,
        minor=float(np.linalg.eigvalsh(scatter)[0]) * moved.spacing,
        conflict=contradicted / (contradicted + count),
        explained=count / inside.size,
        error=float(np.sqrt(np.mean(residual**2))),
        against=contradicted * moved.spacing,
    )
