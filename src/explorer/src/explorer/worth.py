"""What is worth a visit: which cells of a map are frontiers, and which frontier points are goals."""

import math
from typing import Dict, List, NamedTuple, Sequence

import numpy as np

from explorer import _kernels
from explorer._kernels import near_any
from explorer.frontiers import Frontier
from explorer.grid import OccupancyMap
from explorer.verdicts import Verdicts

# Unknown islands smaller than this, in square metres, are gaps between laser beams, not places to go to.
SMALLEST_UNKNOWN_AREA = 0.04

TOLD_DISTANCE = 0.5  # m, own frontiers this near to an explored point of another robot are no goals


def frontier_cells(occupancy: OccupancyMap, minimal_length: float) -> np.ndarray:
    """(height, width) bool array of the frontier cells of a map.

    A frontier cell is free, has an unknown cell among its 8 neighbours and no occupied one. Unknown islands below
    `SMALLEST_UNKNOWN_AREA` make no frontier, and connected frontiers shorter than `minimal_length` metres are noise.
    """
    resolution = occupancy.info.resolution
    return _kernels.frontier_cells(
        occupancy.cells,
        occupancy.FREE_BELOW,
        occupancy.OCCUPIED_FROM,
        max(1, int(SMALLEST_UNKNOWN_AREA / resolution**2)),
        _cells_of_length(minimal_length, resolution),
    )


def _cells_of_length(length: float, resolution: float) -> int:
    """The least number of cells that are at least as long, both in metres."""
    count = max(0, math.floor(length / resolution) - 1)
    while count * resolution < length:
        count += 1
    return count


class Worth(NamedTuple):
    """`goals`: {number: frontier} of the points that are worth a visit now. `told`: some are not only because another
    robot says that it has explored them."""

    goals: Dict[int, Frontier]
    told: bool


def worth_of(frontiers: Sequence[Frontier], verdicts: Verdicts, now: float) -> Worth:
    """Which frontier points are goals, by what is known of them."""
    goals: List[Frontier] = [frontier for frontier in frontiers if verdicts.is_goal(frontier.number)]
    points = np.array([(f.x, f.y) for f in goals], dtype=float).reshape(-1, 2)
    told = near_any(points, verdicts.told_places(now), TOLD_DISTANCE)
    return Worth({f.number: f for f, is_told in zip(goals, told) if not is_told}, bool(told.any()))
