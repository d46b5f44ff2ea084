"""The strategies that need no message: which frontier or cluster of those at hand (contract 3.5)."""

import math
from typing import Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from explorer import assignment
from explorer.clusters import Cluster
from explorer.frontiers import Frontier

Position = Tuple[float, float]

# Weights of strategy 7, tuned with scripts/rehearse.py on several seeds.
GAIN_WEIGHT = 0.1  # m of way that a square metre of unknown area is worth
GAIN_LIMIT = 8.0  # m^2 beyond which more unknown area makes no difference
TURN_WEIGHT = 0.4  # m of way per rad of turning before the start
TOUR_WEIGHT = 1.0  # m of way that a metre of detour in the tour through all clusters is worth
OFFSET = 2.0  # m, keeps bids positive (a negative bid means none)
LOYALTY = 2.0  # m in favour of the cluster that a robot explores already
CROWD_DISTANCE = 4.0  # m, a cluster this near to another robot's costs more
CROWD_PENALTY = 4.0  # m


def distance(a: Position, b: Position) -> float:
    return math.hypot(a[0] - b[0], a[1] - b[1])


def frontier_order(
    strategy: int,
    views: Mapping[int, Tuple[float, float, float]],
    frontiers: Sequence[Frontier],
    place: Position,
    random: np.random.Generator,
) -> List[Frontier]:
    """Frontiers with a viewpoint, best first, for strategies 0 (path), 2 (furthest), 3 (Euclidean) and 4 (random)."""
    candidates = sorted((f for f in frontiers if f.number in views), key=lambda f: f.number)
    if strategy == 0:
        return sorted(candidates, key=lambda f: views[f.number][2])
    if strategy == 4:
        return [candidates[index] for index in random.permutation(len(candidates))]
    return sorted(candidates, key=lambda f: distance(place, (f.x, f.y)), reverse=strategy == 2)


def nearest_member(cluster: Cluster, place: Position) -> Position:
    """Position of the cluster's member with a viewpoint that is nearest to a place."""
    members = [m for m in cluster.members if m.number in cluster.views] or cluster.members
    best = min(members, key=lambda m: (distance(place, (m.x, m.y)), m.number))
    return (best.x, best.y)


def paper_bid(cluster: Cluster, place: Position) -> float:
    """Integer part of the squared Euclidean distance to the cluster (strategy 1)."""
    return assignment.squared_euclidean(place, nearest_member(cluster, place))


def travel_bid(path_length: float, gain: float, turn: float = 0.0, detour: float = 0.0) -> float:
    """Bid of strategy 7 in metres: the way to the cluster, the turn to start it (rad) and the detour that it makes of
    the tour through all clusters, less the worth of what is unknown there (m^2)."""
    bid = OFFSET + path_length + TURN_WEIGHT * abs(turn) + TOUR_WEIGHT * detour
    return max(0.0, bid - GAIN_WEIGHT * min(gain, GAIN_LIMIT))


def assigned_cluster(
    clusters: Sequence[Cluster],
    own_costs: np.ndarray,
    others: Sequence[str],
    costs: np.ndarray,
) -> Optional[Cluster]:
    """The own share of the Hungarian assignment. `costs`: (clusters, others); own costs are the last column."""
    if not clusters:
        return None
    matrix = np.column_stack([np.asarray(costs, dtype=float).reshape(len(clusters), len(others)), own_costs])
    row = assignment.assign(matrix).get(len(others))
    return None if row is None else clusters[row]


def crowd_penalty(cluster: Cluster, claimed: Sequence[np.ndarray]) -> float:
    """Metres that a cluster costs more because claimed places ((n, 2) arrays in metres) are near to it."""
    penalty = 0.0
    points = cluster.points
    for places in claimed:
        if len(places):
            gap = float(np.hypot(*(points[:, None, :] - places[None, :, :]).transpose(2, 0, 1)).min())
            penalty = max(penalty, CROWD_PENALTY * max(0.0, 1.0 - gap / CROWD_DISTANCE))
    return penalty


def bids_by_row(clusters: Sequence[Cluster], bids: Mapping[str, Mapping[int, float]]) -> Dict[str, Dict[int, float]]:
    """Bids keyed by cluster number to bids keyed by row in `clusters`."""
    rows = {cluster.number: row for row, cluster in enumerate(clusters)}
    return {
        robot: {rows[number]: bid for number, bid in offered.items() if number in rows}
        for robot, offered in bids.items()
    }
