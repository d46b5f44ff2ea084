"""The compiled parts: the search for the nearest like-facing point against a plain one, borders, refinement."""

import math

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from map_merger._surfaces import SurfaceIndex, border, raster
from map_merger.obstacles import obstacles_of
from mr_grid import Pose

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


def room(width=6.0, height=4.0, step=0.05):
    """The inner faces of a rectangular room's walls: points and normals."""
    along, up = np.arange(0.0, width, step), np.arange(0.0, height, step)
    sides = [
        (np.column_stack([along, np.zeros_like(along)]), (0.0, 1.0)),
        (np.column_stack([along, np.full_like(along, height)]), (0.0, -1.0)),
        (np.column_stack([np.zeros_like(up), up]), (1.0, 0.0)),
        (np.column_stack([np.full_like(up, width), up]), (-1.0, 0.0)),
    ]
    points = np.concatenate([points for points, _ in sides])
    return points, np.concatenate([np.tile(normal, (len(points), 1)) for points, normal in sides])


@settings(max_examples=100, deadline=None)
@given(st.floats(-0.15, 0.15), st.floats(-0.15, 0.15), st.floats(-0.03, 0.03), st.floats(-3.0, 3.0))
def test_refinement_finds_the_way_back(x, y, turn, heading):
    points, normals = room()
    truth, error = Pose(2.0, -1.0, heading), Pose(x, y, turn)
    target = SurfaceIndex(truth.apply(points), Pose(0.0, 0.0, heading).apply(normals), WEIGHT)
    found = target.refined(points, normals, truth.compose(error), [0.6, 0.45, 0.3, 0.3, 0.2, 0.2, 0.2])
    assert np.abs(Pose(*found).apply(points) - truth.apply(points)).max() < 0.02


def test_walls_that_face_the_other_way_are_no_partners():
    points, normals = room()
    index = SurfaceIndex(points, normals, WEIGHT)
    start = (0.1, 0.0, 0.0)
    assert index.refined(points, -normals, start, [0.3]) == start


def test_comparison_counts_what_agrees_and_what_contradicts():
    points, normals = room(width=6.0, height=4.0)
    index = SurfaceIndex(points, normals, WEIGHT)
    known = np.ones((100, 140), bool)
    known[:, 120:] = False
    clear = known.copy()
    solid = np.ones(len(points), bool)
    origin = (-0.5, -0.5, 0.0)

    def compared(transform, solid=solid):
        return index.compare(known, clear, 0.05, origin, points, normals, solid, transform, 0.1)

    same = compared((0.0, 0.0, 0.0))
    assert same.inside == same.matched == (points[:, 0] < 5.499).sum()
    assert same.contradicted == 0 and same.mean_square == pytest.approx(0.0, abs=1e-12)
    assert same.minor == pytest.approx(min((normals[points[:, 0] < 5.499] ** 2).sum(axis=0)))
    moved = compared((0.0, 0.5, 0.0))
    assert moved.contradicted == moved.inside - moved.matched > 100
    assert compared((0.0, 0.5, 0.0), ~solid).contradicted == 0


def test_border_of_a_straight_wall_has_two_faces():
    free = np.ones((20, 30), bool)
    wall = np.array([[10, column] for column in range(5, 25)])
    free[10, 5:25] = False
    points, normals, numbers = border(wall, free, 0.05, (1.0, 2.0, 0.0))
    assert len(points) == 2 * len(wall) and sorted(numbers) == sorted([*range(len(wall))] * 2)
    assert np.abs(normals[:, 0]).max() < 0.2 and set(np.sign(normals[:, 1])) == {-1.0, 1.0}
    assert points[:, 1] - 2.0 == pytest.approx((10.5 + 0.5 * normals[:, 1]) * 0.05)
    free[11:] = False
    assert (border(wall, free, 0.05, (1.0, 2.0, 0.0))[1][:, 1] < 0).all()


def faces_of(walls, free, turn=0.0):
    return border(np.argwhere(walls), free & ~walls, 0.05, (0.0, 0.0, turn))


@pytest.mark.parametrize("thickness", [4, 5, 8, 20])
def test_a_thick_wall_has_two_faces(thickness):
    """In an office whose walls were seen from both sides nearly all of them were gone, and transforms turned by a
    degree on what was left."""
    walls = np.zeros((60, 60), bool)
    walls[20 : 20 + thickness, 10:50] = True
    points, normals, _ = faces_of(walls, np.ones((60, 60), bool))
    for side, y in ((-1.0, 20 * 0.05), (1.0, (20 + thickness) * 0.05)):
        face = points[(normals[:, 1] * side > 0.9) & (points[:, 0] > 0.65) & (points[:, 0] < 2.35)]
        assert len(face) == 34 and face[:, 1] == pytest.approx(y)


@pytest.mark.parametrize("between", range(1, 8))
def test_faces_of_a_wall_whose_inside_was_not_seen(between):
    walls, free = np.zeros((60, 60), bool), np.ones((60, 60), bool)
    walls[[20, 21 + between], 10:50] = True
    free[21 : 21 + between, 10:50] = False
    points, normals, _ = faces_of(walls, free)
    for side in (-1.0, 1.0):
        face = points[(normals[:, 1] * side > 0.9) & (points[:, 0] > 0.65) & (points[:, 0] < 2.35)]
        assert len(face) == 34


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, math.pi), st.integers(4, 9))
def test_faces_of_a_slanted_wall_are_where_it_ends(seed, angle, thickness):
    """Of any thickness and direction, its cells ragged as noise leaves them: the faces look out of it."""
    rows, columns = np.mgrid[:80, :80] - 39.5
    across, along = (
        columns * math.cos(angle) + rows * math.sin(angle),
        rows * math.cos(angle) - columns * math.sin(angle),
    )
    ragged = np.random.default_rng(seed).uniform(-0.5, 0.5, across.shape)
    walls = (np.abs(across) + ragged < thickness / 2.0) & (np.abs(along) < 25.0)
    points, normals, _ = faces_of(walls, np.ones(walls.shape, bool))
    cells = points / 0.05 - 40.0
    middle = np.abs(cells[:, 1] * math.cos(angle) - cells[:, 0] * math.sin(angle)) < 20.0
    off = cells[middle, 0] * math.cos(angle) + cells[middle, 1] * math.sin(angle)
    outward = normals[middle, 0] * math.cos(angle) + normals[middle, 1] * math.sin(angle)
    right = (np.abs(np.abs(off) - thickness / 2.0) < 1.5) & (np.sign(off) * outward > 0.8)
    assert right.sum() > 50 and right.mean() > 0.9


def test_raster_counts_points_and_refuses_those_outside():
    cells = raster(np.array([[0.1, 0.1], [0.15, 0.1], [0.5, 0.3]]), (0.2, 0.0, 0.0), (0.2, 0.0), 0.2, (2, 3), 0.5)
    assert cells.tolist() == [[1.0, 0.0, 0.0], [0.0, 0.0, 0.5]]
    for outside in ([-0.01, 0.1], [0.1, 0.5], [math.nan, 0.1]):
        with pytest.raises(ValueError, match="outside"):
            raster(np.array([outside]), (0.0, 0.0, 0.0), (0.0, 0.0), 0.2, (2, 3), 1.0)


def test_border_refuses_obstacles_off_the_map():
    with pytest.raises(ValueError, match="off the map"):
        border(np.array([[2, 0]]), np.ones((2, 2), bool), 0.05, (0.0, 0.0, 0.0))


@pytest.mark.parametrize("shape", [(0, 5), (5, 0), (0, 0)])
def test_a_map_without_cells_has_no_obstacles(shape):
    obstacles = obstacles_of(np.ones(shape, bool))
    assert obstacles.labels.shape == shape and obstacles.extents().tolist() == [0]


@pytest.mark.parametrize("shape", [(1, 6), (6, 1)])
def test_obstacles_of_a_narrow_map(shape):
    obstacles = obstacles_of(np.array([0, 1, 1, 0, 1, 0], bool).reshape(shape))
    assert obstacles.extents()[1:].tolist() == [2, 1]
    assert obstacles.labels.ravel().tolist() == [0, 1, 1, 0, 2, 0]


def test_what_is_no_number_is_no_geometry():
    wall, free = np.array([[1, 1]]), np.ones((3, 3), bool)
    for resolution, origin in ((math.inf, (0.0, 0.0, 0.0)), (0.05, (math.nan, 0.0, 0.0))):
        with pytest.raises(ValueError):
            border(wall, free, resolution, origin)


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 30), st.integers(1, 30), st.floats(0.05, 0.8))
def test_statistics_of_obstacles_are_those_of_opencv(seed, height, width, share):
    occupied = np.random.default_rng(seed).random((height, width)) < share
    count, labels, statistics, centres = cv2.connectedComponentsWithStats(occupied.view(np.uint8), connectivity=8)
    found = obstacles_of(occupied)
    assert np.array_equal(found.labels, labels)
    if count > 1:
        left, top, across, up, area = statistics[1:].T
        assert np.array_equal(found.boxes[1:], np.stack([top, left, top + up, left + across], axis=1))
        assert np.array_equal(found.areas[1:], area) and np.array_equal(found.extents()[1:], np.maximum(across, up))
        assert found.centres[1:] == pytest.approx(centres[1:, ::-1])
