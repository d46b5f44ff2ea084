"""The compiled loops against slow plain code."""

import itertools
import math
from typing import Tuple

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra

from explorer._kernels import (
    WeightedGrid,
    any_in_box,
    cells_near,
    cells_within,
    changed_tiles,
    components,
    connected_part,
    distances_to,
    frontier_cells,
    large_frontiers,
    lines_are_clear,
    near_any,
    nearest_near,
    nearest_views,
    pooled_maximum,
    search_views,
    thin,
    within_any,
)

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


def frontier_cells_by_reference(cells: np.ndarray, smallest_unknown: int, smallest_frontier: int) -> np.ndarray:
    """By the connected components of whole images."""
    square = np.ones((3, 3), dtype=np.uint8)
    _, islands = cv2.connectedComponents((cells < 0).astype(np.uint8), connectivity=4)
    unknown = (cells < 0) & (np.bincount(islands.ravel())[islands] >= smallest_unknown)
    near_unknown = cv2.dilate(unknown.astype(np.uint8), square) > 0
    near_occupied = cv2.dilate((cells >= 50).astype(np.uint8), square) > 0
    found = (cells >= 0) & (cells < 25) & near_unknown & ~near_occupied
    count, labels = cv2.connectedComponents(cv2.dilate(found.astype(np.uint8), square), connectivity=8)
    return found & (np.bincount(labels[found], minlength=count)[labels] >= smallest_frontier)


@settings(max_examples=200)
@given(seeds, st.integers(1, 20), st.integers(0, 12))
def test_frontier_cells(seed: int, smallest_unknown: int, smallest_frontier: int) -> None:
    random = np.random.default_rng(seed)
    shape = tuple(random.integers(1, 40, 2))
    shares = random.dirichlet((8.0, 3.0, 0.1, 0.1))
    cells = random.choice(np.array([0, -1, 30, 100], dtype=np.int8), shape, p=shares)
    expected = frontier_cells_by_reference(cells, smallest_unknown, smallest_frontier)
    assert (frontier_cells(cells, 25, 50, smallest_unknown, smallest_frontier) == expected).all()


@settings(max_examples=60)
@given(seeds)
def test_points_near_places(seed: int) -> None:
    random = np.random.default_rng(seed)
    points, places = random.uniform(-3, 3, (20, 2)), random.uniform(-3, 3, (int(random.integers(0, 9)), 2))
    gaps = np.hypot(*(points[:, None] - places[None]).transpose(2, 0, 1))
    assert (near_any(points, places, 0.7) == (gaps < 0.7).any(axis=1)).all()


@settings(max_examples=60)
@given(seeds)
def test_the_nearest_of_places_and_whether_one_is_within_reach(seed: int) -> None:
    random = np.random.default_rng(seed)
    # On a lattice places are as far away as others, and as far as the limit.
    points, places = (0.05 * random.integers(-40, 40, (count, 2)) for count in (20, int(random.integers(0, 30))))
    gaps = np.hypot(*(points[:, None] - places[None]).transpose(2, 0, 1))
    assert (within_any(points, places, 0.7) == (gaps <= 0.7).any(axis=1)).all()
    near = near_any(points, places, 0.7)
    expected = np.where(near, gaps.argmin(axis=1), -1) if len(places) else np.full(20, -1)
    assert (nearest_near(points, places, 0.7) == expected).all()


@settings(max_examples=60)
@given(seeds, st.floats(0.01, 2.0))
def test_thinned_points_cover_all_and_not_each_other(seed: int, distance: float) -> None:
    random = np.random.default_rng(seed)
    points = random.uniform(-3, 3, (60, 2)) + random.choice([0.0, -1e5])
    kept = []
    for index, point in enumerate(points):
        if not any(np.abs(points[other] - point).max() < distance for other in kept):
            kept.append(index)
    assert thin(points, distance).tolist() == kept


@settings(max_examples=60)
@given(seeds)
def test_views_are_near_and_clear(seed: int) -> None:
    random = np.random.default_rng(seed)
    blocked = random.random((30, 40)) < 0.1
    allowed = random.random((15, 20)) < 0.2
    allowed[0, 0] = True
    closed = (~allowed).astype(np.uint8)
    labels = cv2.distanceTransformWithLabels(closed, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)[1]
    places = np.flatnonzero(allowed)
    points = random.uniform((-1.5, 1.5), (2.5, 5.0), (10, 2))
    coarse, fine = (0.2, -1.0, 2.0), (0.1, -1.0, 2.0)
    groups = np.sort(random.integers(0, 3, 10))
    views = nearest_views(coarse, labels, places, fine, blocked, points, groups, 0.6)
    cells = np.clip(np.floor((points - (-1.0, 2.0)) / 0.2).astype(int), 0, (19, 14))
    nearest = places[labels[cells[:, 1], cells[:, 0]] - 1]
    centres = np.column_stack((nearest % 20 + 0.5, nearest // 20 + 0.5)) * 0.2 + (-1.0, 2.0)
    starts, ends = (np.floor((p - (-1.0, 2.0)) / 0.1).astype(int)[:, ::-1] for p in (centres, points))
    clear = [lines_are_clear(blocked, starts[groups == group], ends[groups == group]) for group in range(3)]
    seen = np.concatenate(clear) & (np.hypot(*(centres - points).T) <= 0.6)
    assert (views == np.where(seen, nearest, -1)).all()


@settings(max_examples=60)
@given(seeds, st.floats(0.0, 0.08), st.sampled_from([0.05, 0.1]))
def test_distances_are_those_of_opencv(seed: int, share: float, resolution: float) -> None:
    random = np.random.default_rng(seed)
    cells = random.random(tuple(random.integers(1, 50, 2))) < share
    cells[tuple(random.integers(cells.shape))] = True
    expected = cv2.distanceTransform((~cells).astype(np.uint8), cv2.DIST_L2, 5) * np.float32(resolution)
    assert (distances_to(cells, resolution) == expected).all()
    reach = float(random.uniform(0.0, 1.0))
    assert (cells_near(cells, resolution, reach) == (cells | (expected < np.float32(reach)))).all()
    assert not cells_near(np.zeros_like(cells), resolution, reach).any()


@settings(max_examples=60)
@given(seeds)
def test_components_are_numbered_by_their_first_nodes(seed: int) -> None:
    random = np.random.default_rng(seed)
    count = int(random.integers(1, 20))
    edges = random.integers(0, count, (int(random.integers(0, 20)), 2))
    matrix = coo_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    assert (components(count, edges) == connected_components(matrix, directed=False)[1]).all()
    with pytest.raises(IndexError):
        components(count, np.array([[0, count]]))


@settings(max_examples=100)
@given(seeds, st.integers(1, 12))
def test_sparse_frontiers_are_those_of_the_grid(seed: int, smallest: int) -> None:
    random = np.random.default_rng(seed)
    found = random.random(tuple(random.integers(1, 40, 2))) < random.uniform(0.0, 0.15)
    _, labels = cv2.connectedComponents(cv2.dilate(found.astype(np.uint8), np.ones((3, 3), np.uint8)), connectivity=8)
    expected = np.bincount(labels[found], minlength=labels.max() + 1)[labels[found]] >= smallest
    assert (large_frontiers(np.flatnonzero(found), found.shape[1], smallest) == expected).all()


@settings(max_examples=100)
@given(seeds, st.floats(0.2, 0.8))
def test_connected_part_is_that_of_opencv(seed: int, share: float) -> None:
    random = np.random.default_rng(seed)
    cells = random.random(tuple(random.integers(1, 40, 2))) < share
    labels = cv2.connectedComponents(cells.astype(np.uint8), connectivity=8)[1]
    row, col = (int(random.integers(n)) for n in cells.shape)
    assert (connected_part(cells, row, col) == (cells & cells[row, col] & (labels == labels[row, col]))).all()
    with pytest.raises(ValueError, match="outside"):
        connected_part(cells, cells.shape[0], 0)


@settings(max_examples=100)
@given(seeds, st.floats(0.2, 0.8), st.integers(0, 12))
def test_cells_within_are_those_of_dilation_step_by_step(seed: int, share: float, steps: int) -> None:
    random = np.random.default_rng(seed)
    cells = random.random(tuple(random.integers(1, 40, 2))) < share
    seeds = np.flatnonzero(random.random(cells.size) < 0.02)
    expected = np.zeros(cells.size, dtype=bool)
    expected[seeds] = True
    expected = expected.reshape(cells.shape) & cells
    for _ in range(steps):
        expected = cv2.dilate(expected.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool) & cells
    assert (cells_within(cells, seeds, steps) == expected).all()
    with pytest.raises(ValueError, match="outside"):
        cells_within(cells, np.array([cells.size]), steps)


@settings(max_examples=60)
@given(seeds, st.integers(0, 5))
def test_any_in_box(seed: int, reach: int) -> None:
    random = np.random.default_rng(seed)
    cells = random.random(tuple(random.integers(1, 30, 2))) < 0.05
    middles = random.integers(-7, 37, (20, 2))
    for near, (row, col) in zip(any_in_box(cells, middles, reach), middles.tolist()):
        box = np.s_[max(0, row - reach) : max(0, row + reach + 1), max(0, col - reach) : max(0, col + reach + 1)]
        assert near == cells[box].any()


@settings(max_examples=60)
@given(seeds, st.integers(1, 9))
def test_changed_tiles(seed: int, edge: int) -> None:
    random = np.random.default_rng(seed)
    before = random.integers(-1, 3, tuple(random.integers(1, 40, 2))).astype(np.int8)
    after = np.where(random.random(before.shape) < 0.02, before + 1, before).astype(np.int8)
    tiles = changed_tiles(before, after, edge)
    assert tiles.shape == tuple(-(-n // edge) for n in before.shape)
    for row, col in np.ndindex(tiles.shape):
        tile = np.s_[row * edge : (row + 1) * edge, col * edge : (col + 1) * edge]
        assert tiles[row, col] == (before[tile] != after[tile]).any()


@settings(max_examples=60)
@given(seeds, st.floats(0.0, 0.3))
def test_search_tries_every_third_place_from_near_to_far(seed: int, share: float) -> None:
    random = np.random.default_rng(seed)
    blocked, reachable = random.random((30, 40)) < share, random.random((15, 20)) < 0.3
    points = random.uniform((-1.5, 1.5), (3.5, 5.5), (10, 2))
    found = search_views((0.2, -1.0, 2.0), reachable, (0.1, -1.0, 2.0), blocked, points, 0.9)
    for point, view in zip(points, found.tolist()):
        row, col = np.floor((point - (-1.0, 2.0)) / 0.2).astype(int)[::-1]
        cells = np.argwhere(reachable)
        cells = cells[np.abs(cells - (row, col)).max(axis=1) <= 4]
        cells = cells[np.argsort(np.hypot(*(cells - (row, col)).T), kind="stable")[::3]]
        centres = (cells[:, ::-1] + 0.5) * 0.2 + (-1.0, 2.0)
        starts, end = (np.floor((p - (-1.0, 2.0)) / 0.1).astype(int)[..., ::-1] for p in (centres, point))
        seen = lines_are_clear(blocked, starts, np.broadcast_to(end, starts.shape))
        seen &= np.hypot(*(centres - point).T) <= 0.9
        expected = cells[int(np.argmax(seen))] @ (20, 1) if seen.any() else -1
        assert view == expected
