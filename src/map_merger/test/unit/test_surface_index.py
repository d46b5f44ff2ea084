"""The search for the nearest like-facing point against a plain one over all points."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from map_merger._surface_index import SurfaceIndex

WEIGHT = 0.3


def oriented(generator, count, extent):
    angles = generator.uniform(-math.pi, math.pi, count)
    points = generator.uniform(-0.5, 0.5, (count, 2)) * extent
    return points, np.stack([np.cos(angles), np.sin(angles)], axis=1)


@settings(max_examples=200, deadline=None)
@given(
    st.integers(0, 2**32 - 1), st.integers(1, 300), st.floats(0.01, 200.0), st.floats(0.0, 200.0), st.floats(0.01, 3.0)
)
def test_nearest_is_the_nearest_of_all(seed, count, width, height, bound):
    generator = np.random.default_rng(seed)
    points, normals = oriented(generator, count, (width, height))
    queries, facing = oriented(generator, 50, (1.2 * width, 1.2 * height + 0.1))
    found = SurfaceIndex(points, normals, WEIGHT).nearest(queries, facing, bound)
    here = np.hstack([points, WEIGHT * normals])
    there = np.hstack([queries, WEIGHT * facing])
    distance = np.linalg.norm(there[:, None, :] - here[None, :, :], axis=2)
    least = distance.min(axis=1)
    assert np.array_equal(found >= 0, least < bound)
    chosen = distance[np.flatnonzero(found >= 0), found[found >= 0]]
    assert chosen == pytest.approx(least[found >= 0], abs=1e-9)


def test_no_points_no_neighbours():
    nothing = np.empty((0, 2))
    index = SurfaceIndex(nothing, nothing, WEIGHT)
    assert list(index.nearest(np.zeros((2, 2)), np.zeros((2, 2)), 10.0)) == [-1, -1]
    assert SurfaceIndex(np.zeros((1, 2)), np.zeros((1, 2)), WEIGHT).nearest(nothing, nothing, 10.0).shape == (0,)


def test_points_far_apart_take_no_memory_for_what_lies_between():
    points = np.array([[-1e5, -1e5], [1e5, 1e5]])
    normals = np.array([[1.0, 0.0], [1.0, 0.0]])
    assert list(SurfaceIndex(points, normals, WEIGHT).nearest(points + 0.1, normals, 1.0)) == [0, 1]


@pytest.mark.parametrize(
    "points, normals", [((2, 2), (3, 2)), ((2, 3), (2, 3)), ((4,), (4,))], ids=["lengths", "columns", "flat"]
)
def test_wrong_shapes_are_refused(points, normals):
    with pytest.raises(ValueError, match="shape"):
        SurfaceIndex(np.zeros(points), np.zeros(normals), WEIGHT)


def test_what_is_no_number_is_refused():
    with pytest.raises(ValueError, match="finite"):
        SurfaceIndex(np.array([[math.nan, 0.0]]), np.array([[1.0, 0.0]]), WEIGHT)
