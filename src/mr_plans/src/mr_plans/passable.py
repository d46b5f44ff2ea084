"""Makes a drawn floor fit to drive in: closed outside, one connected space for a robot inside.

A robot is a disc on the lattice. Where it fits with room to spare (`WIDE_CELLS`, in narrow worlds `NARROW_CELLS`) it
can drive; where it fits only just (`TIGHT_CELLS`) nobody can say whether a navigation gets through, so nothing may lie
behind such a place. All in whole numbers, so that every computer gets the same.
"""

from dataclasses import replace
from typing import Optional, Tuple

import numpy as np

from .plan import FloorPlan

OUTER_CELLS = 2
"""Thickness of the outer wall."""
WIDE_CELLS, NARROW_CELLS, TIGHT_CELLS = 7, 5, 4
"""Robots are told to fit into a cell if no wall cell is within so many cells, from centre to centre. At 0.05 m per cell
these are openings from 0.75 m, 0.55 m and 0.45 m on: for robots 0.38 m wide that keep 0.05 m away from walls, which
their maps draw up to a cell thicker than they are."""
_BESIDE_CELLS = 3
_POCKET_CELLS = 120
"""A pocket of so many places (0.3 m2) is worth clearing the way to it; a smaller one is filled."""
_TRIALS = 40


def passable(plan: FloorPlan, room: int = WIDE_CELLS) -> FloorPlan:
    """The plan with its outer wall closed, without the furniture that cuts space off, and with what cannot be reached
    all the same filled up. `room`: cells that robots need around them. Keeps no aliases."""
    walls = plan.walls.copy()
    furniture = np.zeros_like(walls) if plan.furniture is None else plan.furniture & walls
    for edge in (np.s_[:OUTER_CELLS], np.s_[-OUTER_CELLS:], np.s_[:, :OUTER_CELLS], np.s_[:, -OUTER_CELLS:]):
        walls[edge], furniture[edge] = True, False
    for trial in range(_TRIALS):
        reached, pockets = _parts(walls, room)
        if not pockets.any():
            break
        blocking = _blocking(furniture, reached, _large(pockets), room) if trial < _TRIALS // 2 else None
        if blocking is not None:
            walls &= ~blocking
            furniture &= ~blocking
        else:
            filled = pockets | (_grown(pockets, TIGHT_CELLS) & ~_grown(reached, room) & ~walls)
            walls |= filled
            furniture |= filled
    return replace(plan, walls=walls, furniture=furniture, aliases=())


def places(walls: np.ndarray, cells: int) -> np.ndarray:
    """Cells, bool of the shape of `walls`, around which no wall cell is within that many cells."""
    import cv2  # here and below, for who needs no picture: it is slow to import

    return cv2.dilate(walls.astype(np.uint8), disc(cells), borderType=cv2.BORDER_CONSTANT, borderValue=1) == 0


def reachable(walls: np.ndarray, room: int = NARROW_CELLS) -> np.ndarray:
    """The largest connected part (bool, as `walls`) of the places that a robot can drive through."""
    return _largest(places(walls, room))


def disc(cells: int) -> np.ndarray:
    """Offsets within that many cells, uint8 (2 cells + 1, 2 cells + 1)."""
    offsets = np.arange(-cells, cells + 1)
    return (offsets[:, None] ** 2 + offsets**2 <= cells**2).astype(np.uint8)


def _parts(walls: np.ndarray, room: int) -> Tuple[np.ndarray, np.ndarray]:
    """Where a robot can drive, and the places that it cannot reach or only through a tight one."""
    roomy, tight = places(walls, room), places(walls, TIGHT_CELLS)
    reached = _largest(roomy)
    near = _grown(reached, room)
    return reached, (roomy & ~reached) | (tight & ~near)


def _largest(mask: np.ndarray) -> np.ndarray:
    import cv2

    count, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=4)
    if count == 1:
        return np.zeros_like(mask)
    found: np.ndarray = labels == 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    return found


def _large(pockets: np.ndarray) -> np.ndarray:
    import cv2

    _, labels, stats, _ = cv2.connectedComponentsWithStats(pockets.astype(np.uint8), connectivity=8)
    large = stats[:, cv2.CC_STAT_AREA] >= _POCKET_CELLS
    large[0] = False
    found: np.ndarray = large[labels]
    return found


def _blocking(furniture: np.ndarray, reached: np.ndarray, pockets: np.ndarray, room: int) -> Optional[np.ndarray]:
    """The pieces of furniture (bool mask) that stand between the reached space and a pocket; None without any."""
    import cv2

    if not pockets.any() or not furniture.any():
        return None
    beside = room + _BESIDE_CELLS
    touching = _grown(pockets, beside) & furniture
    _, labels = cv2.connectedComponents(furniture.astype(np.uint8), connectivity=8)
    between = np.intersect1d(labels[touching], labels[_grown(reached, beside) & furniture])
    return np.isin(labels, between) if between.size else None


def _grown(mask: np.ndarray, cells: int) -> np.ndarray:
    import cv2

    grown: np.ndarray = cv2.dilate(mask.astype(np.uint8), disc(cells)) > 0
    return grown
