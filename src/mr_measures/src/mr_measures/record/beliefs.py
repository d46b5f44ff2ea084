"""What one robot believes of where the others' maps lie in its own: which changes are worth an entry."""

from __future__ import annotations

import math
from collections.abc import Mapping

from mr_grid import Pose, normalized

MOVED, TURNED = 0.05, 0.01  # m, rad: a transform that has changed by more is a new one


class Beliefs:
    """Later refinements of a transform count only when it has come far from what was told last."""

    def __init__(self) -> None:
        self._told: dict[str, Pose] = {}

    def changes(self, present: Mapping[str, Pose]) -> list[tuple[str, Pose | None]]:
        """`present`: all transforms that are believed now, by robot. Robots with their new transform, None for one that
        is no longer believed."""
        lost: list[tuple[str, Pose | None]] = [(name, None) for name in sorted(self._told.keys() - present.keys())]
        new = [
            (name, transform)
            for name, transform in present.items()
            if name not in self._told or _apart(self._told[name], transform)
        ]
        told = {**self._told, **dict(new)}
        self._told = {name: told[name] for name in present}
        return [*lost, *new]


def _apart(first: Pose, second: Pose) -> bool:
    moved = math.hypot(first.x - second.x, first.y - second.y)
    return moved > MOVED or abs(normalized(first.yaw - second.yaw)) > TURNED
