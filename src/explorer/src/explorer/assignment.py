"""Who goes where: the Hungarian assignment of robots to clusters, with bids that are missing interpolated."""

import math
from typing import Callable, Dict, Mapping, Optional, Sequence, Tuple

import numpy as np

Position = Tuple[float, float]

# Stands in for "impossible": far above any sum of real costs, far below where float64 loses centimetres.
FORBIDDEN = 1e9


def assign(costs: np.ndarray) -> Dict[int, int]:
    """{column: row} of the cheapest one-to-one assignment of a (rows, columns) cost matrix.

    Rectangular matrices need no padding. Entries that are infinite (or `FORBIDDEN` and above) are never assigned:
    as many as possible of the others are, at the least sum.
    """
    from scipy.optimize import linear_sum_assignment  # slow to import, and many a program only names strategies

    costs = np.asarray(costs, dtype=float)
    if costs.size == 0:
        return {}
    bounded = np.where(np.isfinite(costs), np.minimum(costs, FORBIDDEN), FORBIDDEN)
    rows, columns = linear_sum_assignment(bounded)
    return {int(c): int(r) for r, c in zip(rows, columns) if bounded[r, c] < FORBIDDEN}


def assigned(others: np.ndarray, own: np.ndarray) -> Optional[int]:
    """The own row in the cheapest assignment. `others`: (rows, robots) costs of the other robots; `own`: (rows,)."""
    if len(own) == 0:
        return None
    return assign(np.column_stack([others, own])).get(others.shape[1])


def cost_matrix(
    clusters: int,
    robots: Sequence[str],
    bids: Mapping[str, Mapping[int, float]],
    positions: Mapping[str, Position],
    interpolate: Callable[[Position, int], float],
) -> np.ndarray:
    """(clusters, robots) costs. `bids[robot][cluster]` where given; a bid that is missing or negative is
    interpolated from the robot's last known position, and without one the pair is impossible (infinite)."""
    costs = np.full((clusters, len(robots)), math.inf)
    for column, robot in enumerate(robots):
        offered = bids.get(robot, {})
        position: Optional[Position] = positions.get(robot)
        for row in range(clusters):
            bid = offered.get(row, -1.0)
            if bid >= 0:
                costs[row, column] = bid
            elif position is not None:
                costs[row, column] = interpolate(position, row)
    return costs


def squared_euclidean(a: Position, b: Position) -> float:
    """Integer part of the squared distance in square metres: the paper's bid (contract 3.7)."""
    return float(int((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2))
