"""The parts of meetings by themselves: detection, tracking, fits, clocks."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from meeting_scene import WIDE, Actor, Scene, room, standing

from map_merger.meetings.detection import objects_in_scan
from map_merger.meetings.fitting import fitted, transform_from
from map_merger.meetings.heard import Heard
from map_merger.meetings.map_objects import objects_in_map
from map_merger.meetings.sweeps import SweepHistory
from map_merger.meetings.tracking import ObjectTracks, Trail, at_times
from map_merger.meetings.values import LaserScan, TrackReport
from map_merger.robot_size import USUAL_SIZE
from mr_grid import GridInfo, OccupancyGrid, Pose


def scan_of(others, walls=(), view=WIDE):
    scene = Scene([Actor("a", standing(0.0, 0.0), view=view)], walls, others)
    return scene.scan(scene.robots[0])


@pytest.mark.parametrize(("x", "y"), [(0.8, 0.0), (2.0, 1.0), (-0.5, 2.0), (4.0, -2.0)])
def test_the_centre_of_a_body_is_found_behind_its_surface(x, y):
    centres = objects_in_scan(scan_of([standing(x, y)], room(14.0, 11.0)), USUAL_SIZE).centres
    assert len(centres) == 1
    assert math.hypot(*(centres[0] - (x, y))) < 0.08


def test_walls_their_corners_and_what_is_too_wide_or_far_are_no_objects():
    table = [standing(1.5, 0.3 * step - 0.6) for step in range(5)]
    assert len(objects_in_scan(scan_of([], room(14.0, 11.0)), USUAL_SIZE).centres) == 0
    assert len(objects_in_scan(scan_of(table, room(14.0, 11.0)), USUAL_SIZE).centres) == 0
    assert len(objects_in_scan(scan_of([standing(7.0, 0.0)]), USUAL_SIZE).centres) == 0


def test_what_is_hidden_in_part_or_cut_by_the_edge_of_the_view_is_no_object():
    half_hidden = [standing(1.0, 0.0), standing(2.0, 0.35)]
    assert len(objects_in_scan(scan_of(half_hidden), USUAL_SIZE).centres) == 1
    assert len(objects_in_scan(scan_of([standing(1.0, 0.0)], view=math.radians(15.0)), USUAL_SIZE).centres) == 0


@pytest.mark.parametrize("first", [-math.pi, 0.0, 0.1, 3.0])
@pytest.mark.parametrize("place", [0.0, 1.0, -2.0])
def test_a_sensor_that_goes_round_finds_what_its_first_and_last_beams_see(first, place):
    """Lasers of many small robots begin straight ahead."""
    angles = first + 2.0 * math.pi / 720 * np.arange(720)
    off = np.abs(np.angle(np.exp(1j * (angles - place))))
    scan = LaserScan(np.where(off < 0.15, 1.0 / np.cos(off), 4.0), first, 2.0 * math.pi / 720, 0.1, 8.0)
    centres = objects_in_scan(scan, USUAL_SIZE).centres
    assert len(centres) == 1 and math.atan2(centres[0][1], centres[0][0]) == pytest.approx(place, abs=0.02)


def test_a_scan_of_nothing_or_of_nothing_valid_has_no_objects():
    for ranges in (np.full(100, 8.0), np.full(100, np.nan), np.zeros(100)):
        assert len(objects_in_scan(LaserScan(ranges, -1.0, 0.02, 0.1, 8.0), USUAL_SIZE).centres) == 0


@pytest.mark.parametrize("fields", [(np.zeros(2), 0.0, 0.1, 0.0, 8.0), (np.zeros(9), math.nan, 0.1, 0.0, 8.0)])
def test_a_scan_that_cannot_be_used_is_refused(fields):
    with pytest.raises(ValueError, match="scan"):
        LaserScan(*fields)


def test_small_isolated_obstacles_of_a_map_are_objects():
    cells = np.zeros((100, 100), np.int8)
    cells[:, 0] = 100
    cells[50:56, 60:66] = 100
    centres = objects_in_map(OccupancyGrid(GridInfo(100, 100, 0.05), cells), Pose(2.0, 2.0), 6.0, USUAL_SIZE.widest)
    assert centres == pytest.approx(np.array([[3.15, 2.65]]), abs=0.03)


def test_objects_are_followed_past_one_another():
    tracks = ObjectTracks()
    for step in range(40):
        time = 0.2 * step
        tracks.take(time, np.array([[-2.0 + 0.5 * time, 0.3], [2.0 - 0.5 * time, -0.3]]))
    first, second = tracks.fragments(8.0)
    assert np.allclose(first.samples[:, 2], 0.3) and np.allclose(second.samples[:, 2], -0.3)


def test_an_object_out_of_sight_for_long_is_another_one_afterwards():
    tracks = ObjectTracks()
    for time in (0.0, 0.2, 0.4, 3.0, 3.2, 3.4):
        tracks.take(time, np.array([[1.0, 0.0]]))
    numbers = [fragment.number for fragment in tracks.fragments(3.4)]
    assert len(numbers) == len(set(numbers)) == 2


def test_tracks_begin_anew_when_the_clock_jumps_back():
    tracks = ObjectTracks()
    tracks.take(100.0, np.array([[1.0, 0.0]]))
    tracks.take(1.0, np.array([[1.0, 0.0]]))
    assert len(tracks.fragments(1.0)) == 1


def test_places_between_rows_far_apart_are_known_only_of_a_robot_that_rests():
    rows = np.array([[0.0, 0.0, 0.0], [0.5, 1.0, 0.0], [3.0, 2.0, 0.0], [8.0, 2.0, 0.01]])
    places, known = at_times(rows, np.array([-1.0, 0.25, 1.5, 5.0, 9.0]))
    assert known.tolist() == [False, True, False, True, False]
    assert places[1] == pytest.approx(0.5) and places[3] == pytest.approx(2.0, abs=0.01)


def test_a_trail_is_bounded_in_time_and_number():
    trail = Trail(3, 0.02)
    for step in range(5000):
        trail.add((0.1 * step, 0.0, 0.0))
    assert len(trail.rows) <= 300 and trail.rows[0, 0] >= 499.9 - 30.1
    trail.add((5.0, 1.0, 1.0))
    assert len(trail.rows) == 1


@given(
    st.floats(-math.pi, math.pi),
    st.floats(-50.0, 50.0),
    st.floats(-50.0, 50.0),
    st.lists(st.complex_numbers(max_magnitude=20.0, allow_nan=False), min_size=3, max_size=20),
)
def test_a_fit_gives_back_the_transform(yaw, x, y, points):
    source = np.array(points) + np.arange(len(points))
    if np.abs(source - source.mean()).max() < 0.1:
        return
    turn, shift = fitted(source, source * np.exp(1j * yaw) + complex(x, y))
    found = transform_from(turn, shift)
    assert abs(np.exp(1j * found.yaw) - np.exp(1j * yaw)) < 1e-5
    assert (found.x, found.y) == pytest.approx((x, y), abs=1e-3)


def report(uptime, ages=(0.0,), boot=(1, 0)):
    poses = np.array([[age, uptime - age, 0.0, 0.0] for age in ages])
    return TrackReport("b", USUAL_SIZE.body_radius, boot, uptime, poses=poses)


def test_the_fastest_report_sets_the_clock():
    """Each place is at x = uptime, so the track shows by how much the clocks are taken to differ."""
    heard = Heard()
    for uptime, delay in ((5.0, 0.4), (6.0, 0.05), (7.0, 0.9)):
        heard.take(report(uptime, (0.5, 0.0)), uptime + 100.0 + delay)
    track = heard.track()
    assert track[:, 0] - track[:, 1] == pytest.approx(100.05)
    assert len(track) == 6


def test_reports_that_come_late_or_twice_change_nothing_but_fill_gaps():
    heard = Heard()
    for arrival, uptime in enumerate((5.0, 7.0, 6.0, 6.0)):
        heard.take(report(uptime), 110.0 + arrival)
    assert heard.track()[:, 1].tolist() == [5.0, 6.0, 7.0]


def test_another_run_or_a_clock_set_back_forgets():
    heard = Heard()
    assert not heard.take(report(500.0), 600.0)
    assert heard.take(report(501.0, boot=(2, 0)), 601.0) and len(heard.track()) == 1
    assert heard.take(report(5.0, boot=(2, 0)), 602.0) and len(heard.track()) == 1
    assert not heard.take(report(6.0, boot=(2, 0)), 603.0) and len(heard.track()) == 2


@pytest.mark.parametrize(("first", "turn"), [(-math.pi, 1.0), (0.0, 1.0), (0.0, -1.0), (2.0, 1.0)])
def test_a_sensor_that_goes_round_sees_all_around_wherever_it_begins(first, turn):
    """Lasers whose angles begin at 0 saw nothing on the right, and told that they saw nothing at all."""
    angles, sweeps = first + turn * 2.0 * math.pi / 720 * np.arange(720), SweepHistory()
    ranges = np.where(np.cos(angles) > math.cos(0.1), 2.0, 5.0)
    scan = LaserScan(ranges, first, turn * 2.0 * math.pi / 720, 0.1, 8.0)
    places = np.array([2.0 + 0j, 2j, -2j, -2.0 + 0j, 4.0 + 0j])
    for time in range(len(places)):
        sweeps.add(float(time), scan, Pose())
    seen = sweeps.all().look(places, np.ones(5, bool))
    assert seen.there.tolist() == [True, False, False, False, False]
    assert seen.empty.tolist() == [False, True, True, True, False]
    assert scan.sensor.view == pytest.approx(2.0 * math.pi, abs=0.01)


def test_a_laser_that_takes_a_beam_more_or_less_is_one_sensor():
    """Each sweep began the history anew, and nothing was ever seen where another robot was."""
    sweeps = SweepHistory()
    for time, beams in enumerate([360, 361, 359, 360, 362]):
        angles = -math.pi + 2.0 * math.pi / beams * np.arange(beams)
        ranges = np.where(np.abs(angles - 1.0) < 0.15, 2.0, 5.0)
        sweeps.add(float(time), LaserScan(ranges, -math.pi, 2.0 * math.pi / beams, 0.1, 8.0), Pose())
    places = np.full(5, 2.0 * complex(math.cos(1.0), math.sin(1.0)))
    assert sweeps.all().look(places, np.ones(5, bool)).there.all()
    assert sweeps.all().look(-places, np.ones(5, bool)).empty.all()
    sweeps.add(5.0, LaserScan(np.full(180, 5.0), 0.0, math.pi / 180, 0.1, 8.0), Pose())
    assert len(sweeps.all().ranges) == 1, "another field of view is another sensor"


def test_what_is_beside_the_view_is_neither():
    scan = LaserScan(np.full(541, 5.0), -0.75 * math.pi, 1.5 * math.pi / 540, 0.1, 8.0)
    assert scan.sensor.view == pytest.approx(1.5 * math.pi)
    sweeps = SweepHistory()
    for time in range(3):
        sweeps.add(float(time), scan, Pose())
    seen = sweeps.all().look(np.array([-2.0 + 0j, -2.0 + 1.9j, -2.0 - 1.9j]), np.ones(3, bool))
    assert not seen.there.any() and not seen.empty.any()


def test_a_place_in_sight_is_empty_or_not_and_a_hidden_one_neither():
    sweeps = SweepHistory()
    scan = scan_of([standing(2.0, 0.0)], room(14.0, 11.0))
    for time in (1.0, 2.0, 3.0, 4.0):
        sweeps.add(time, scan, Pose())
    places = np.array([2.0 + 0j, 1.0 + 1j, 4.0 + 0j, -2.0 + 0j])
    seen = sweeps.all().look(places, np.ones(4, bool))
    assert seen.there.tolist() == [True, False, False, False]
    assert seen.empty.tolist() == [False, True, False, False]
