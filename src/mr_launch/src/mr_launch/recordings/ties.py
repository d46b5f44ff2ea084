"""Where the map frames of the robots lie in one common frame."""

from __future__ import annotations

from typing import Mapping

from mr_grid import Pose

Believed = Mapping[str, Mapping[str, Pose]]
"""robot: other: pose of the other's map in the robot's map, as its map_merger said last."""


def by_transforms(robots: list[str], believed: Believed) -> dict[str, Pose]:
    """The map of the first robot is the common frame. Others by as few transforms as lead there; those that none
    leads to are left out."""
    places = {robots[0]: Pose(0.0, 0.0, 0.0)}
    waiting = [robots[0]]
    for known in waiting:
        for other in robots:
            transform = _between(known, other, believed)
            if other not in places and transform is not None:
                places[other] = places[known].compose(transform)
                waiting.append(other)
    return places


def _between(robot: str, other: str, believed: Believed) -> Pose | None:
    there = believed.get(robot, {}).get(other)
    if there is not None:
        return there
    back = believed.get(other, {}).get(robot)
    return None if back is None else back.inverse()
