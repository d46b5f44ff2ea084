"""A floor plan as a value: what is solid, what of it can be moved, and which motions lay it on itself."""

from dataclasses import dataclass
from typing import NamedTuple, Optional, Tuple

import numpy as np


class Motion(NamedTuple):
    """Turn by `yaw` (rad) about the world's origin, then shift by `x`, `y` (m)."""

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0


@dataclass(frozen=True, eq=False)
class FloorPlan:
    """A building: walls (bool, row 0 at the south), metres per cell; the world's origin is its south-west corner.

    aliases: motions that lay much of the building on exact copies. furniture: the part of `walls` that can be moved,
    of the same shape; None if nothing can.
    """

    walls: np.ndarray
    resolution: float = 0.05
    aliases: Tuple[Motion, ...] = ()
    furniture: Optional[np.ndarray] = None

    def holds(self, place: np.ndarray) -> bool:
        """True if the place (x, y) in metres is inside the building."""
        rows, columns = self.walls.shape
        return bool(0.0 < place[0] < columns * self.resolution and 0.0 < place[1] < rows * self.resolution)


def plan_from_image(path: str, resolution: float) -> FloorPlan:
    """Floor plan from an image, dark = wall, first image row at the north; FileNotFoundError if it cannot be read."""
    import cv2  # here, for who needs no picture: it is slow to import

    image = cv2.imread(path, cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise FileNotFoundError(f"no readable image at {path}")
    return FloorPlan(np.ascontiguousarray(image[::-1] < 128), resolution)
