"""Distances and turns in the plane: metres and radians."""

import math
from typing import Tuple

from mr_grid import Pose

Position = Tuple[float, float]


def distance(a: Position, b: Position) -> float:
    return math.hypot(a[0] - b[0], a[1] - b[1])


def apart(a: Pose, b: Pose) -> float:
    return math.hypot(a.x - b.x, a.y - b.y)


def turn(before: float, after: float) -> float:
    """Smallest turn from one heading to another, rad."""
    return math.atan2(math.sin(after - before), math.cos(after - before))
