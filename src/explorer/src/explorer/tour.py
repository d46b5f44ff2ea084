"""How much way each first stop costs in the end: shortest open tours through clusters (Held and Karp 1962)."""

import functools
import itertools
import math
from typing import List, Sequence, Tuple

import numpy as np

from explorer.travel import SNAP_DISTANCE, TravelGrid

# Stops that are considered; the exact solution doubles its work with each further one.
MAXIMUM_STOPS = 9


def tour_lengths(to_stops: np.ndarray, between: np.ndarray) -> np.ndarray:
    """(n,) length in metres of the shortest open tour that goes to stop i first and then to all others.

    `to_stops`: (n,) way from the robot; `between`: (n, n) ways between stops, symmetric; at most `MAXIMUM_STOPS`.
    """
    n = len(to_stops)
    if n > MAXIMUM_STOPS:
        raise ValueError(f"{n} stops, at most {MAXIMUM_STOPS} can be ordered")
    if n == 0:
        return np.zeros(0)
    # rest[s, i]: shortest way that starts at i and visits all stops of the set s (i not among them).
    rest = np.full((1 << n, n), math.inf)
    rest[0] = 0.0
    for subsets, members, without in _subsets_by_size(n):
        onward = rest[without, members]
        rest[subsets] = (between[:, members] + onward).min(axis=2).T
    everything = (1 << n) - 1
    return np.array([to_stops[i] + rest[everything & ~(1 << i), i] for i in range(n)])


@functools.lru_cache(maxsize=None)
def _subsets_by_size(n: int) -> List[Tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """For each size m from 1 to n all sets of m of n stops, as bit masks (s,), their members (s, m), and the masks of
    the sets without each member (s, m)."""
    tables = []
    for size in range(1, n + 1):
        members = np.array(list(itertools.combinations(range(n), size)), dtype=np.intp)
        bits = 1 << members
        subsets = bits.sum(axis=1)
        tables.append((subsets, members, subsets[:, None] - bits))
    return tables


def ways_between(grid: TravelGrid, stops: Sequence[Tuple[float, float]]) -> np.ndarray:
    """(n, n) path lengths in metres between n places on a `TravelGrid`, infinite where no path leads."""
    cells = [grid.nearest(grid.traversable, x, y, 2 * SNAP_DISTANCE) for x, y in stops]
    ways = np.full((len(stops), len(stops)), math.inf)
    placed = [(index, cell) for index, cell in enumerate(cells) if cell is not None]
    indices = [index for index, _ in placed]
    ways[np.ix_(indices, indices)] = grid.weighted.costs_between([cell for _, cell in placed])
    return ways
