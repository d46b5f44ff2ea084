"""The track of a robot: bounded, and no place is forgotten before others."""

import numpy as np

from map_merger.places import thinned
from map_merger.whereabouts import LONGEST_TRACK, TRACK_SPACING_M, Track


def test_a_robot_that_goes_round_for_hours_forgets_no_part_of_its_way():
    track = Track()
    angles = np.arange(0.0, 40.0 * 2.0 * np.pi, TRACK_SPACING_M / 20.0)
    for time, angle in enumerate(angles.tolist()):
        track.add(20.0 * np.cos(angle), 20.0 * np.sin(angle), float(time))
    points, times = track.points(), track.timed_points()[:, 2]
    assert len(points) <= LONGEST_TRACK
    assert (np.diff(times) > 0.0).all()
    seen = np.sort(np.arctan2(points[:, 1], points[:, 0]))
    assert 20.0 * np.diff(seen).max() < 0.5


def test_a_long_way_is_thinned_out_evenly():
    track = Track()
    for step in range(16_000):
        track.add(0.2 * step, 0.0, float(step))
    gaps = np.diff(track.points()[:, 0])
    assert len(track.points()) <= LONGEST_TRACK
    assert gaps.max() < 2 * 8 * 0.2


def test_of_each_square_the_last_point_is_kept():
    points = np.array([[0.05, 0.05], [0.25, 0.05], [0.1, 0.1], [0.25, 0.1]])
    assert thinned(points, 3, 0.2).tolist() == [2, 3]
    assert thinned(points, 1, 0.2).tolist() == [3]
