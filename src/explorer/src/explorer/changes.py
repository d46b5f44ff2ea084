"""Where a map differs from the one before, so that only this is computed again."""

from typing import List, Optional, Tuple

import numpy as np

from explorer._kernels import changed_tiles
from mr_grid.imaging import parts_of

TILE = 32  # cells, edge of the squares in which changes are looked for
MOST_OF_A_MAP = 0.5  # share of the cells beyond which all of them are computed

Window = Tuple[slice, slice]
"""Of rows and columns, inside a grid."""


def changed_windows(before: np.ndarray, after: np.ndarray) -> Optional[List[Window]]:
    """Windows that hold all cells in which two int8 grids (rows, cols) differ, none if they are equal; None if that is
    most of the grid or the grids are not of one shape."""
    if before is after:
        return []
    if before.shape != after.shape:
        return None
    tiles = changed_tiles(before, after, TILE)
    windows = [_window(box.tolist(), after.shape) for box in parts_of(tiles).boxes[1:]]
    area = sum((rows.stop - rows.start) * (cols.stop - cols.start) for rows, cols in windows)
    return windows if area <= MOST_OF_A_MAP * after.size else None


def _window(tiles: List[int], shape: Tuple[int, ...]) -> Window:
    """`tiles`: the left one, the top one, how many across and how many down."""
    left, top, width, height = tiles
    return (
        slice(TILE * top, min(TILE * (top + height), shape[0])),
        slice(TILE * left, min(TILE * (left + width), shape[1])),
    )


def grown(window: Window, reach: int, shape: Tuple[int, ...]) -> Window:
    """The window with `reach` cells more on each side, as far as the grid goes."""
    rows, cols = (slice(max(0, s.start - reach), min(n, s.stop + reach)) for s, n in zip(window, shape))
    return rows, cols


def aligned(window: Window, edge: int, shape: Tuple[int, ...]) -> Window:
    """The whole blocks of edge x edge cells that the window touches; those at the far edges of the grid are cut off."""
    rows, cols = (slice(s.start // edge * edge, min(n, -(-s.stop // edge) * edge)) for s, n in zip(window, shape))
    return rows, cols


def blocks(window: Window, edge: int) -> Window:
    """The cells of a grid coarser by `edge` that an aligned window stands for."""
    rows, cols = (slice(s.start // edge, -(-s.stop // edge)) for s in window)
    return rows, cols


def within(window: Window, outer: Window) -> Window:
    """Where in an outer window a window lies."""
    rows, cols = (slice(s.start - o.start, s.stop - o.start) for s, o in zip(window, outer))
    return rows, cols
