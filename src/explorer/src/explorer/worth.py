"""What is worth a visit: which cells of a map are frontiers, and which frontier points are goals."""

import math
from typing import Dict, Mapping, NamedTuple, Sequence

import numpy as np

from explorer import _kernels
from explorer._kernels import near_any
from explorer.clusters import Cluster
from explorer.frontiers import Frontier
from explorer.grid import OccupancyMap
from explorer.prospects import Prospect
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
    """`goals`: {number: frontier} of the points that are worth a visit now. `reasons`: {number: reason} why the others
    are not, in words for people. `told`: some are not only because another robot says that it has explored them."""

    goals: Dict[int, Frontier]
    reasons: Dict[int, str]
    told: bool


VISITED, GIVEN_UP, TOLD = "visited", "given up", "told by another robot"
NOISE, CLOSED, SMALL = "noise", "no robot fits in", "too small for a goal of its own"

import os
W_AREA=float(os.environ.get('W_AREA','0.4'))
W_ENTER=float(os.environ.get('W_ENTER','0'))
W_BIG=float(os.environ.get('W_BIG','99'))
W_DEPTH=float(os.environ.get('W_DEPTH','0'))
W_COUNT=int(os.environ.get('W_COUNT','3'))


def worth_of(clusters: Sequence[Cluster], prospects: Mapping[int, Prospect], verdicts: Verdicts, now: float) -> Worth:
    """Which members of the clusters are goals, by what is unknown behind them and what was decided about them."""
    reasons: Dict[int, str] = {}
    for cluster in clusters:
        reasons.update(_reasons(cluster, prospects))
    for cluster in clusters:
        reasons.update({m.number: VISITED if verdicts.of(m.number).visited else GIVEN_UP
                        for m in cluster.members if not verdicts.is_goal(m.number)})
    goals = [m for cluster in clusters for m in cluster.members if m.number not in reasons]
    points = np.array([(f.x, f.y) for f in goals], dtype=float).reshape(-1, 2)
    told = near_any(points, verdicts.told_places(now), TOLD_DISTANCE)
    reasons.update({f.number: TOLD for f, is_told in zip(goals, told) if is_told})
    return Worth({f.number: f for f in goals if f.number not in reasons}, reasons, bool(told.any()))


def _reasons(cluster, prospects):
    r = {}
    for m in cluster.members:
        p = prospects[m.number]
        if p.area < W_AREA or p.depth < W_DEPTH:
            r[m.number] = NOISE
        elif p.enterable < W_ENTER and p.area < W_BIG:
            r[m.number] = CLOSED
    good = [m for m in cluster.members if m.number not in r]
    passable = any(prospects[m.number].passable for m in good)
    if not (len(good) >= W_COUNT or (len(good) >= W_COUNT - 1 and passable)):
        r.update({m.number: SMALL for m in good})
    return r
