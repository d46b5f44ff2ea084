"""The compiled loops against slow plain code."""

import itertools
import math
from typing import Tuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from explorer._kernels import WeightedGrid, lines_are_clear, pooled_maximum

seeds = st.integers(0, 2**32 - 1)


def random_weights(seed: int, heaviest: float = 3.0) -> Tuple[np.ndarray, np.random.Generator]:
    """float32 (rows, cols) with walls, and the generator that drew it."""
    random = np.random.default_rng(seed)
    shape = tuple(random.integers(1, 18, 2))
    weights = random.uniform(1.0, heaviest, shape).astype(np.float32)
    weights[random.random(shape) < random.uniform(0.0, 0.6)] = math.inf
    return weights, random


def costs_by_reference(weights: np.ndarray, resolution: float, start: Tuple[int, int]) -> np.ndarray:
    """scipy's algorithm of Dijkstra on the graph, its edges found cell by cell."""
    rows, cols = weights.shape
    edges = []
    for row, col, down, right in itertools.product(range(rows), range(cols), (-1, 0, 1), (-1, 0, 1)):
        end = (row + down, col + right)
        if (down or right) and 0 <= end[0] < rows and 0 <= end[1] < cols:
            mean = 0.5 * (float(weights[row, col]) + float(weights[end]))
            if math.isfinite(mean):
                length = mean * resolution * math.hypot(down, right)
                edges.append((length, row * cols + col, end[0] * cols + end[1]))
    lengths, starts, ends = np.array(edges).reshape(-1, 3).T
    graph = coo_matrix((lengths, (starts.astype(int), ends.astype(int))), shape=(rows * cols, rows * cols))
    costs = dijkstra(graph.tocsr(), indices=start[0] * cols + start[1]).reshape(rows, cols)
    return np.where(np.isfinite(weights), costs, math.inf)


@settings(max_examples=100)
@given(seeds, st.sampled_from([0.05, 0.1, 1.0]), st.sampled_from([1.0, 3.0, 40.0]))
def test_costs_are_those_of_dijkstra(seed: int, resolution: float, heaviest: float) -> None:
    weights, random = random_weights(seed, heaviest)
    grid = WeightedGrid(weights, resolution)
    start = (int(random.integers(weights.shape[0])), int(random.integers(weights.shape[1])))
    costs = grid.costs_from(*start)
    # The lengths of single steps are float32.
    expected = costs_by_reference(weights, resolution, start)
    np.testing.assert_allclose(costs, expected, rtol=2e-7 if math.isfinite(weights[start]) else 0.0)
    assert np.isinf(costs[np.isinf(weights)]).all()
    if math.isinf(weights[start]):
        assert np.isinf(costs).all()


@settings(max_examples=60)
@given(seeds)
def test_costs_between_cells_are_symmetric_and_those_of_single_fields(seed: int) -> None:
    weights, random = random_weights(seed)
    grid = WeightedGrid(weights, 0.1)
    cells = [tuple(int(random.integers(n)) for n in weights.shape) for _ in range(int(random.integers(0, 8)))]
    ways = grid.costs_between(cells)
    assert ways.shape == (len(cells), len(cells))
    assert (ways == ways.T).all() and (ways.diagonal() == 0.0).all()
    for i, j in itertools.combinations(range(len(cells)), 2):
        np.testing.assert_allclose(ways[i, j], grid.costs_from(*cells[i])[cells[j]], rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(ways[i, j], grid.costs_from(*cells[j])[cells[i]], rtol=0.0, atol=1e-9)


@settings(max_examples=60)
@given(seeds)
def test_paths_lead_back_with_the_summed_cost(seed: int) -> None:
    weights, random = random_weights(seed)
    grid = WeightedGrid(weights, 0.1)
    start, end = (tuple(int(random.integers(n)) for n in weights.shape) for _ in range(2))
    costs = grid.costs_from(*start)
    path = grid.path_to(*end, costs)
    if not math.isfinite(costs[end]):
        assert path == []
        return
    assert path[0] == start and path[-1] == end and len(set(path)) == len(path)
    total = 0.0
    for a, b in zip(path, path[1:]):
        step = (b[0] - a[0], b[1] - a[1])
        assert max(abs(step[0]), abs(step[1])) == 1
        total += 0.1 * math.hypot(*step) * 0.5 * (float(weights[a]) + float(weights[b]))
    assert total == pytest.approx(costs[end], rel=1e-6)


def test_grids_that_make_no_sense_are_refused() -> None:
    with pytest.raises(ValueError, match="shape"):
        WeightedGrid(np.ones(3, dtype=np.float32), 0.1)
    for weight in (0.0, -1.0, math.nan):
        with pytest.raises(ValueError, match="positive"):
            WeightedGrid(np.full((2, 2), weight, dtype=np.float32), 0.1)
    with pytest.raises(ValueError, match="10000"):
        WeightedGrid(np.array([[1.0, 1e9]], dtype=np.float32), 0.1)
    grid = WeightedGrid(np.ones((2, 3), dtype=np.float32), 0.1)
    for cell in ((-1, 0), (2, 0), (0, 3)):
        with pytest.raises(IndexError):
            grid.costs_from(*cell)
        with pytest.raises(IndexError):
            grid.costs_between([(0, 0), cell])
    with pytest.raises(ValueError, match="costs"):
        grid.path_to(0, 0, np.zeros((3, 3)))


def clear_by_reference(blocked: np.ndarray, start: np.ndarray, end: np.ndarray, steps: int) -> bool:
    for step in range(1, steps):
        row, col = np.rint(start + (end - start) * (step / steps)).astype(int)
        if (row, col) in (tuple(start), tuple(end)):
            continue
        if not (0 <= row < blocked.shape[0] and 0 <= col < blocked.shape[1]) or blocked[row, col]:
            return False
    return True


@settings(max_examples=60)
@given(seeds)
def test_lines_of_sight(seed: int) -> None:
    random = np.random.default_rng(seed)
    blocked = random.random((12, 15)) < 0.15
    starts, ends = random.integers(-2, 16, (8, 2)), random.integers(-2, 16, (8, 2))
    steps = int(np.abs(ends - starts).max())
    expected = [clear_by_reference(blocked, start, end, steps) for start, end in zip(starts, ends)]
    assert lines_are_clear(blocked, starts, ends).tolist() == expected
    assert lines_are_clear(blocked, starts[:0], ends[:0]).shape == (0,)


@settings(max_examples=60)
@given(seeds, st.integers(1, 5))
def test_pooling(seed: int, factor: int) -> None:
    random = np.random.default_rng(seed)
    values = random.random(tuple(random.integers(1, 12, 2))).astype(np.float32)
    mask = random.random(values.shape) < 0.3
    pooled = pooled_maximum(values, mask, factor)
    assert pooled.shape == tuple(-(-n // factor) for n in values.shape)
    for row, col in np.ndindex(pooled.shape):
        block = np.s_[row * factor : (row + 1) * factor, col * factor : (col + 1) * factor]
        assert pooled[row, col] == max(values[block][mask[block]], default=-1.0)
