"""What is true between two maps that have drifted."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from mr_grid import OccupancyGrid, Pose, normalized
from mr_measures.drift import Track, best_rigid_fit, overlap

coordinates = st.floats(-20.0, 20.0)
transforms = st.builds(Pose, coordinates, coordinates, st.floats(-3.1, 3.1))


def straight_track(slip_from: float, slip: float) -> Track:
    """Ten metres along x; from `slip_from` on the robot believes to be `slip` m farther back."""
    track = Track()
    for x in np.arange(0.0, 10.01, 0.25):
        track.add(Pose(x, 0.0, 0.0), Pose(x - slip * (x >= slip_from), 0.0, 0.0))
    return track


def corridor(left: float, right: float) -> OccupancyGrid:
    """Known from `left` to `right`, 2 m wide."""
    cells = np.zeros((40, round((right - left) / 0.05)), dtype=np.int8)
    return OccupancyGrid.of(cells, 0.05, Pose(left, -1.0, 0.0))


def apart(first: Pose, second: Pose, points: np.ndarray) -> float:
    """How far, m, two transforms bring one of the points apart at most."""
    return float(np.abs(first.apply(points) - second.apply(points)).max())


@given(transforms, st.integers(0, 2**32 - 1))
@settings(max_examples=50, deadline=None)
def test_the_best_fit_is_the_transform_that_moved_the_points(transform: Pose, seed: int) -> None:
    points = np.random.default_rng(seed).uniform(-5.0, 5.0, (30, 2))
    fit = best_rigid_fit(transform.apply(points), points)
    assert apart(fit, transform, points) < 1e-6
    assert abs(normalized(fit.yaw - transform.yaw)) < 1e-6


def test_places_go_there_and_back() -> None:
    track = straight_track(5.0, 0.5)
    points = np.array([[1.0, 0.5], [3.0, -0.8], [8.0, 0.3]])
    there = track.drifted(points)
    assert np.allclose(there, [[1.0, 0.5], [3.0, -0.8], [7.5, 0.3]])
    assert np.allclose(track.straightened(there), points)


def test_a_turned_robot_turns_what_it_maps() -> None:
    track = Track()
    track.add(Pose(2.0, 0.0, 0.0), Pose(2.0, 0.0, 0.1))
    assert np.allclose(track.drifted(np.array([[3.0, 0.0]])), [[2.0 + math.cos(0.1), math.sin(0.1)]])


def test_a_robot_that_stands_adds_one_pose_to_its_track() -> None:
    track = Track()
    for _ in range(100):
        track.add(Pose(1.0, 1.0, 0.0), Pose(1.5, 1.0, 0.0))
    assert np.allclose(track.drifted(np.array([[9.0, 9.0]])), [[9.5, 9.0]])
    assert len(track) == 1


def test_where_one_map_has_slipped_the_truth_has_moved() -> None:
    """Maps that share only what one of them has 0.4 m too far back fit best 0.4 m beside their starts."""
    start = Pose(1.0, 0.0, 0.0)
    slipped, straight = straight_track(5.0, 0.4), straight_track(99.0, 0.0)
    in_target, in_source = overlap(corridor(0.0, 9.6), slipped, corridor(5.0, 9.0), straight, start)
    assert 20 < len(in_target) <= 400
    fit = best_rigid_fit(in_target, in_source)
    assert apart(fit, Pose(0.6, 0.0, 0.0), in_source) < 0.05


def test_maps_that_share_nothing_have_no_overlap() -> None:
    tracks = straight_track(99.0, 0.0), straight_track(99.0, 0.0)
    in_target, in_source = overlap(corridor(0.0, 4.0), tracks[0], corridor(6.0, 9.0), tracks[1], Pose())
    assert len(in_target) == len(in_source) == 0
