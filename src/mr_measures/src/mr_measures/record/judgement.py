"""Whether a transform between two robots' maps was right when it was believed, as every host judges it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mr_grid import Pose, normalized
from mr_measures.drift import FEWEST_POINTS, best_rigid_fit
from mr_measures.record.robot_record import Merge

Kinds = Callable[[np.ndarray, float], str]
"""Kind of a transform by its displacements (n,) in m and its turn in rad: right, imprecise or wrong."""


def judged(partner: str, at: float, transform: Pose, true: Pose, points: np.ndarray, kind_of: Kinds) -> Merge:
    """The entry of a robot that believes `transform` from `at` s on. `true` and `points` as from `true_transform`."""
    offsets = np.hypot(*(transform.apply(points) - true.apply(points)).T)
    turn = abs(normalized(transform.yaw - true.yaw))
    kind = kind_of(offsets, turn)
    return Merge(
        partner,
        round(at, 3),
        Pose(round(transform.x, 4), round(transform.y, 4), round(transform.yaw, 5)),
        round(float(offsets.max()), 4),
        round(turn, 5),
        kind,
        kind != "wrong",
    )


def true_transform(
    start: Pose, target: np.ndarray, source: np.ndarray, all_of_source: Callable[[], np.ndarray]
) -> tuple[Pose, np.ndarray]:
    """The transform from the source's map to the target's that is true, and the places (n, 2) of the source's map at
    which others differ from it: the best rigid fit over `target` and `source` (n, 2), the same places in either map.
    Where they share too few, that of the starts (`start`: the source's in the frame of the target's) and all places
    that the source knows."""
    if len(source) >= FEWEST_POINTS:
        return best_rigid_fit(target, source), source
    places = all_of_source()
    return start, places if len(places) else np.zeros((1, 2))
