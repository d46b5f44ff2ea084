"""A floor plan as a value: what is solid, what of it can be moved, and which motions lay it on itself."""

from dataclasses import dataclass, replace
from typing import Optional, Tuple

import cv2
import numpy as np

from ..obstacles import obstacles_of
from ..transform import Transform


@dataclass(frozen=True, eq=False)
class FloorPlan:
    """A building: walls (bool, row 0 at the south), metres per cell; the world's origin is its south-west corner.

    aliases: motions that lay much of the building on exact copies. furniture: the part of `walls` that can be moved,
    of the same shape; None if nothing can.
    """

    walls: np.ndarray
    resolution: float = 0.05
    aliases: Tuple[Transform, ...] = ()
    furniture: Optional[np.ndarray] = None

    def holds(self, place: np.ndarray) -> bool:
        """True if the place (x, y) in metres is inside the building."""
        rows, columns = self.walls.shape
        return bool(0.0 < place[0] < columns * self.resolution and 0.0 < place[1] < rows * self.resolution)


def plan_from_image(path: str, resolution: float) -> FloorPlan:
    """Floor plan from an image, dark = wall, first image row at the north; FileNotFoundError if it cannot be read."""
    image = cv2.imread(path, cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise FileNotFoundError(f"no readable image at {path}")
    return FloorPlan(np.ascontiguousarray(image[::-1] < 128), resolution)


def rearranged(plan: FloorPlan, random: np.random.Generator, share: float, farthest: float = 2.0) -> FloorPlan:
    """The building after people were in it: each piece of furniture is moved with the probability `share`, by up to
    `farthest` metres per axis, to where nothing stands; it stays if there is no such place in ten trials."""
    if plan.furniture is None:
        return plan
    walls, furniture = plan.walls.copy(), plan.furniture.copy()
    pieces = obstacles_of(plan.furniture)
    most = round(farthest / plan.resolution)
    for number in range(1, len(pieces.areas)):
        if random.random() < share:
            rows, columns = np.divmod(pieces.cells[pieces.label_of == number], walls.shape[1])
            _move(walls, furniture, rows, columns, random.integers(-most, most + 1, (10, 2)))
    return replace(plan, walls=walls, furniture=furniture)


def _move(walls: np.ndarray, furniture: np.ndarray, rows: np.ndarray, columns: np.ndarray, shifts: np.ndarray) -> None:
    walls[rows, columns] = furniture[rows, columns] = False
    for down, right in [*shifts.tolist(), (0, 0)]:
        there = rows + down, columns + right
        inside = min(there[0].min(), there[1].min()) >= 0
        inside = inside and there[0].max() < walls.shape[0] and there[1].max() < walls.shape[1]
        if inside and not walls[there].any():
            walls[there] = furniture[there] = True
            return
