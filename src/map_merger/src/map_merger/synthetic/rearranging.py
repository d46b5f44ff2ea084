"""Buildings after people were in them."""

from dataclasses import replace

import numpy as np

from mr_plans.plan import FloorPlan

from ..obstacles import obstacles_of


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
