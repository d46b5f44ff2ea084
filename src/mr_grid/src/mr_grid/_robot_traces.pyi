"""What an occupancy grid shows of robots (src/cpp/robot_traces.cpp); see `mr_grid.robot_traces`."""

from typing import Sequence, Tuple

import numpy as np

def find(
    cells: np.ndarray,
    occupied_from: int,
    resolution: float,
    origin: Tuple[float, float],
    places: Sequence[Tuple[float, float]],
    most_apart: float,
    largest: float,
) -> np.ndarray: ...
