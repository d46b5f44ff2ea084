"""Edges as the arrays that the pose graph takes."""

import math
from itertools import chain
from typing import Iterable, Sequence

import numpy as np

from .edges import Edge, arm_to_walls
from .pose_graph import Links

FLOOR_M = 0.05
FLOOR_RAD = math.radians(0.5)
"""Standard deviations that come to those of every edge, at its shared walls: what bent maps may do. At the bound of
consistency they are 0.2 m and 2 deg."""


def links_of(edges: Sequence[Edge], nodes: Sequence[str]) -> Links:
    """The edges in their order, the nodes by their place in the list."""
    number = {robot: index for index, robot in enumerate(nodes)}
    pairs = {pair: index for index, pair in enumerate(sorted({edge.pair for edge in edges}))}
    return Links(
        np.array([number[edge.reporter] for edge in edges], int),
        np.array([number[edge.target] for edge in edges], int),
        _numbers(edge.transform for edge in edges).reshape(-1, 3),
        _widened(_numbers(row for edge in edges for row in edge.covariance).reshape(-1, 3, 3)),
        np.array([edge.weight for edge in edges], float),
        np.array([pairs[edge.pair] for edge in edges], int),
    )


def _numbers(rows: Iterable[Iterable[float]]) -> np.ndarray:
    """All in one row: an array of tuples takes numpy several times as long."""
    return np.fromiter(chain.from_iterable(rows), float)


def _widened(covariances: np.ndarray) -> np.ndarray:
    arms = arm_to_walls(covariances)
    return covariances + arms @ np.diag([FLOOR_M**2, FLOOR_M**2, FLOOR_RAD**2]) @ np.swapaxes(arms, 1, 2)
