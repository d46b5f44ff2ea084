"""Local refinement of a transform: iterated closest surfaces, point to line (Chen and Medioni 1991)."""

from typing import Sequence

from mr_grid import Pose

from .surface import Surface

COARSE_REACH = (0.6, 0.45, 0.3, 0.3, 0.2, 0.2)
FINE_REACH = (0.25, 0.2, 0.15, 0.15, 0.12, 0.12)
"""Search distances in metres, one per iteration."""


def refined(target: Surface, source: Surface, start: Pose, reaches: Sequence[float]) -> Pose:
    """The transform source -> target near `start` that lays like-facing surfaces on one another.

    Directions that the surfaces do not determine (along a lone corridor) keep their start value.
    """
    return Pose(*target.index().refined(source.points, source.normals, start, reaches))
