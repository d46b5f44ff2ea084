"""Local refinement of a transform: iterated closest surfaces, point to line (Chen and Medioni 1991)."""

from typing import Sequence

import numpy as np

from .evidence import moved_surface, nearest
from .surface import Surface
from .transform import Transform, wrap_angle

COARSE_REACH = (0.6, 0.45, 0.3, 0.3, 0.2, 0.2)
FINE_REACH = (0.25, 0.2, 0.15, 0.15, 0.12, 0.12)
"""Search distances in metres, one per iteration."""


def refined(target: Surface, source: Surface, start: Transform, reaches: Sequence[float]) -> Transform:
    """The transform source -> target near `start` that lays like-facing surfaces on one another.

    Directions that the surfaces do not determine (along a lone corridor) keep their start value.
    """
    current = start
    for reach in reaches:
        moved = moved_surface(source, current)
        index, matched = nearest(target, moved, reach)
        if int(matched.sum()) < 6:
            return current
        step = _step(target, moved, index[matched], matched, reach)
        current = step.compose(current)
        if abs(step.x) + abs(step.y) < 5e-4 and abs(step.yaw) < 5e-5:
            break
    return current


def _step(target: Surface, moved: Surface, index: np.ndarray, matched: np.ndarray, reach: float) -> Transform:
    points = moved.points[matched]
    centre = points.mean(axis=0)
    arm = points - centre
    normals = target.normals[index]
    residual = np.einsum("ij,ij->i", points - target.points[index], normals)
    weight = 1.0 / (1.0 + (residual / (0.4 * reach)) ** 2)
    jacobian = np.column_stack([normals, arm[:, 0] * normals[:, 1] - arm[:, 1] * normals[:, 0]])
    hessian = (jacobian * weight[:, None]).T @ jacobian
    damping = np.diag([0.01 * len(points)] * 2 + [0.002 * float((arm**2).sum())]) + 1e-9 * np.eye(3)
    shift_x, shift_y, turn = -np.linalg.solve(hessian + damping, (jacobian * weight[:, None]).T @ residual)
    turn = wrap_angle(float(turn))
    rotation = Transform(0.0, 0.0, turn)
    offset = centre + np.array([shift_x, shift_y]) - rotation.apply(centre[None])[0]
    return Transform(float(offset[0]), float(offset[1]), turn)
