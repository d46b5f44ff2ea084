"""Offers small maps drawn as text."""

import os
import sys
from typing import Sequence

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)

from hypothesis import settings  # noqa: E402

from explorer.grid import OccupancyMap  # noqa: E402
from mr_grid import GridInfo, Pose  # noqa: E402

# The same examples in every run, and no verdict on time from a busy machine.
settings.register_profile("repeatable", derandomize=True, deadline=None, database=None)
settings.load_profile("repeatable")


def map_of(cells: np.ndarray, resolution: float = 0.1, x: float = 0.0, y: float = 0.0) -> OccupancyMap:
    cells = np.asarray(cells, dtype=np.int8)
    return OccupancyMap(GridInfo(cells.shape[1], cells.shape[0], resolution, Pose(x, y)), cells)


def drawn(rows: Sequence[str], scale: int = 1, resolution: float = 0.1) -> OccupancyMap:
    """A map from text, first line at the top (largest y): '#' occupied, '.' free, ' ' unknown; each sign becomes
    scale x scale cells."""
    width = max(len(row) for row in rows)
    values = {"#": 100, ".": 0, " ": -1}
    cells = np.array([[values[sign] for sign in row.ljust(width)] for row in rows[::-1]], dtype=np.int8)
    return map_of(np.kron(cells, np.ones((scale, scale), dtype=np.int8)), resolution)
