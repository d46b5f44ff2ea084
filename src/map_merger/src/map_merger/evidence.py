"""What speaks for and against a transform between two maps."""

import math
from dataclasses import dataclass

from mr_grid import Pose

from ._surfaces import Comparison
from .surface import Landmarks, Surface


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


def compare(target: Landmarks, source: Landmarks, transform: Pose) -> Evidence:
    """Evidence for `transform` (source -> target)."""
    return compare_samples(target, source, target.surface, source.surface, transform)


def compare_samples(
    target: Landmarks, source: Landmarks, target_sample: Surface, source_sample: Surface, transform: Pose
) -> Evidence:
    """Evidence for `transform` (source -> target) from samples of both surfaces: each is sought in the whole of the
    other."""
    if not len(target_sample.points) or not len(source_sample.points):
        return Evidence()
    tolerance = match_tolerance(target, source)
    forward = _one_way(target, source_sample, transform, tolerance)
    backward = _one_way(source, target_sample, transform.inverse(), tolerance)
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


def comparison_of(target: Landmarks, source: Surface, transform: Pose, tolerance: float) -> Comparison:
    """How the walls of the source, moved by `transform`, agree with the target up to `tolerance` (m)."""
    return target.surface.index().compare(
        target.known,
        target.clear,
        target.info.resolution,
        target.info.origin,
        source.points,
        source.normals,
        source.solid,
        transform,
        tolerance,
    )


def _one_way(target: Landmarks, source: Surface, transform: Pose, tolerance: float) -> Evidence:
    spacing = source.spacing
    found = comparison_of(target, source, transform, tolerance)
    if found.matched == 0:
        return Evidence(against=found.contradicted * spacing)
    return Evidence(
        matched=found.matched * spacing,
        minor=found.minor * spacing,
        conflict=found.contradicted / (found.contradicted + found.matched),
        explained=found.matched / found.inside,
        error=math.sqrt(found.mean_square),
        against=found.contradicted * spacing,
    )
