"""What several maps on one lattice say together about each cell.

Two maps of one wall lie up to `SAME_WALL` cells apart: by drift, by the error of the transform, by rounding to cells.
So

1. what more maps hold for wall than for floor, or as many, is wall;
2. a wall goes where another map saw floor and nothing but floor within `SEEN_THROUGH` cells (an open door, a robot that
   has left); floor beside an own wall or unknown cells does not remove it;
3. a wall beside one that is there already is the same wall and not drawn again, unless it closes off floor, or joins
   the one that is there to its own continuation;
4. floor that lies pinched between a wall that is there and the own wall is an error of alignment, no space;
5. a wall that may not be drawn on local floor closes the unknown cells beside it: what the local map saw of the floor
   in front of a wall must not open it;
6. unknown gaps up to two cells wide between maps are closed: by wall beside walls, by floor between floor.

What a cell becomes depends on the cells within `reach` of it only, so that a part can be computed by itself.
"""

from typing import Sequence

import numpy as np

from . import _surfaces

SAME_WALL = 2
SEEN_THROUGH = 3


def reach(foreign: int) -> int:
    """Cells from a cell within which what `foreign` maps know can change it."""
    return SEEN_THROUGH + 2 * SAME_WALL * foreign + 7


def weighed(local: np.ndarray, foreign: Sequence[np.ndarray], locked: bool) -> np.ndarray:
    """The global map, int8 (rows, columns), of the local one and others of the same shape, which count in their order.

    `locked`: known local cells stay as they are; otherwise the local map is the first among equals. ValueError for maps
    of different shapes.
    """
    return _surfaces.weighed([local, *foreign], locked, SAME_WALL, SEEN_THROUGH)
