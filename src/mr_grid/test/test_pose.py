"""The algebra of poses in the plane."""

import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mr_grid import FARTHEST, Pose, is_place, normalized, pose_of

METRES = st.floats(-1e3, 1e3, allow_nan=False)
ANGLES = st.floats(-math.pi, math.pi, exclude_min=True)
POSES = st.builds(Pose, METRES, METRES, ANGLES)
POINTS = st.lists(st.tuples(METRES, METRES), min_size=1, max_size=5).map(np.array)


def assert_same(first, second):
    assert first[:2] == pytest.approx(second[:2], abs=1e-8)
    assert abs(normalized(first.yaw - second.yaw)) < 1e-9


@given(st.floats(-1e6, 1e6))
def test_a_normalized_angle_is_the_same_direction_in_one_turn(angle):
    result = normalized(angle)
    assert -math.pi < result <= math.pi
    assert (math.cos(result), math.sin(result)) == pytest.approx((math.cos(angle), math.sin(angle)), abs=1e-9)
    assert normalized(result) == result


def test_half_a_turn_has_one_value():
    assert normalized(-math.pi) == normalized(math.pi) == math.pi
    assert Pose(yaw=math.pi).inverse().yaw == math.pi
    assert Pose(yaw=-math.pi / 2).compose(Pose(yaw=-math.pi / 2)).yaw == math.pi


@given(POSES, POSES, POSES)
def test_poses_are_a_group(a, b, c):
    assert_same(a.compose(b).compose(c), a.compose(b.compose(c)))
    assert_same(a.compose(a.inverse()), Pose())
    assert_same(a.inverse().compose(a), Pose())
    assert_same(a.compose(Pose()), a)
    assert_same(Pose().compose(a), a)


@given(POSES, POSES)
def test_the_pose_between_two_leads_from_one_to_the_other(a, b):
    assert_same(a.compose(a.between(b)), b)
    assert_same(a.between(b), b.between(a).inverse())


@given(POSES, POSES, POINTS)
def test_points_go_through_composed_poses_one_after_the_other(a, b, points):
    assert a.compose(b).apply(points) == pytest.approx(a.apply(b.apply(points)), abs=1e-8)
    assert a.apply_inverse(a.apply(points)) == pytest.approx(points, abs=1e-8)
    assert a.apply_inverse(points) == pytest.approx(a.inverse().apply(points), abs=1e-8)
    assert [a.apply_point(x, y) for x, y in points] == pytest.approx(a.apply(points), abs=1e-8)


@given(METRES, METRES, POINTS)
def test_without_rotation_both_ways_to_undo_give_the_same_bits(x, y, points):
    assert np.array_equal(Pose(x, y).apply_inverse(points), points - (x, y))
    assert np.array_equal(Pose(x, y).inverse().apply(points), points - (x, y))


@given(POSES, POSES)
def test_on_the_way_the_shorter_turn_is_taken(a, b):
    assert_same(a.interpolate(b, 0.0), a)
    assert_same(a.interpolate(b, 1.0), b)
    turned = abs(normalized(a.interpolate(b, 0.5).yaw - a.yaw))
    assert turned <= math.pi / 2 + 1e-9


def test_a_pose_is_a_tuple_with_names():
    pose = Pose(1.0, 2.0, 0.5)
    assert pose == (1.0, 2.0, 0.5) and Pose() == (0.0, 0.0, 0.0) and hash(pose) == hash(Pose(1.0, 2.0, 0.5))
    assert pickle.loads(pickle.dumps(pose)) == pose
    with pytest.raises(AttributeError):
        pose.x = 3.0


def test_a_pose_is_read_from_three_finite_numbers():
    assert pose_of([1, "2", 3.0 * math.pi]) == (1.0, 2.0, pytest.approx(math.pi))
    for values in ([1, 2], [1, 2, 3, 4], [1, 2, math.nan], [math.inf, 2, 3]):
        with pytest.raises(ValueError, match="a pose is"):
            pose_of(values)


def test_places_are_of_a_usable_size():
    assert is_place(FARTHEST, -FARTHEST)
    assert not any(is_place(0.0, value) for value in (math.nan, math.inf, 1.001 * FARTHEST))
