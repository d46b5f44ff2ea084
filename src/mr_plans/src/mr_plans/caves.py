"""Caves for worlds: in whole numbers only, because a threshold on floating-point noise differs between computers."""

import numpy as np

from .drawing import RESOLUTION
from .passable import WIDE_CELLS, disc, places
from .plan import FloorPlan

_COARSE = 4
"""Cells per value of the random field."""
_SMOOTHING = 5, 5, 7
"""Widths of the boxes that the field is averaged over, one after the other, in values."""
_OPEN_PERCENT = 62
_THROAT_CELLS = WIDE_CELLS + 1
"""Radius of the narrowest passage: 0.8 m wide."""


def cave(random: np.random.Generator, length: float, depth: float) -> FloorPlan:
    """The largest of the hollows of a smooth random field, without passages that are too narrow."""
    import cv2  # here, for who needs no picture: it is slow to import

    rows, columns = round(depth / RESOLUTION), round(length / RESOLUTION)
    hollow = _hollows(random, -(-rows // _COARSE), -(-columns // _COARSE))
    fine = np.repeat(np.repeat(hollow, _COARSE, axis=0), _COARSE, axis=1)[:rows, :columns]
    open_cells = cv2.medianBlur(fine.astype(np.uint8), 5)
    for edge in (np.s_[:3], np.s_[-3:], np.s_[:, :3], np.s_[:, -3:]):
        open_cells[edge] = 0
    wide = places(open_cells == 0, _THROAT_CELLS).astype(np.uint8)
    _, labels, stats, _ = cv2.connectedComponentsWithStats(wide, connectivity=4)
    largest = labels == 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    return FloorPlan(cv2.dilate(largest.astype(np.uint8), disc(_THROAT_CELLS)) == 0, RESOLUTION)


def _hollows(random: np.random.Generator, rows: int, columns: int) -> np.ndarray:
    """The lowest values of the smoothed field, bool (rows, columns)."""
    margin = sum(_SMOOTHING)
    field = random.integers(0, 1 << 16, (rows + margin, columns + margin))
    for _ in range(2):
        for width in _SMOOTHING:
            field = _summed(_summed(field, width).T, width).T
        missing = rows + margin - field.shape[0], columns + margin - field.shape[1]
        field = np.pad(field >> 12, ((0, missing[0]), (0, missing[1])), "wrap")
    field = field[:rows, :columns]
    limit = np.sort(field, axis=None)[field.size * _OPEN_PERCENT // 100]
    return np.asarray(field < limit)


def _summed(field: np.ndarray, width: int) -> np.ndarray:
    """Sums over `width` rows, (rows - width + 1, columns)."""
    sums = np.cumsum(field, axis=0)
    sums[width:] -= sums[:-width].copy()
    return sums[width - 1 :]
