"""What map_merger/MergerStatus says, whoever has read it."""

from __future__ import annotations

from typing import Any

from mr_grid import Pose


def transforms_of(message: Any) -> dict[str, Pose]:
    """Where the maps of other robots lie in the own one."""
    placed = [other for other in message.robots if other.placed and other.robot != message.robot]
    return {other.robot: Pose(other.x, other.y, other.yaw) for other in placed}
