"""The bounds hold for robots that can do more than ours, and say something."""

import itertools
import math

import numpy as np
import pytest

from mr_grid import Pose
from mr_measures.lower_bound import LowerBound
from mr_measures.visibility import DrivingDistance, Views
from mr_sim.true_world import true_world_of
from mr_sim.world import World
from mr_sim.world_model import load_world

# Two rooms of 5 m x 4 m beside each other, with a wall of 0.1 m and a door of 1 m at the top between them.
WORLD = """
resolution 0.05
interval_sim 100
define robot position
(
  drive "diff"
  size [ 0.4 0.4 0.2 ]
  velocity_bounds [ -0.4 0.4 0 0 0 0 -90 90 ]
  ranger ( pose [ 0.1 0 0 0 ] sensor ( range [ 0 8 ] fov 270 samples 100 ) )
)
model ( size [ 10 0.1 1 ] pose [ 5 0.05 0 0 ] )
model ( size [ 10 0.1 1 ] pose [ 5 3.95 0 0 ] )
model ( size [ 0.1 4 1 ] pose [ 0.05 2 0 0 ] )
model ( size [ 0.1 4 1 ] pose [ 9.95 2 0 0 ] )
model ( size [ 0.1 2.9 1 ] pose [ 5 1.45 0 0 ] )
robot ( name "a" pose [ 1 1 0 0 ] )
robot ( name "b" pose [ 2 1 0 0 ] )
"""
START = Pose(1.0, 1.0, 0.0)
DOOR = (5.0, 3.4)
SPEED = 0.4


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    path = tmp_path_factory.mktemp("world") / "rooms.world"
    path.write_text(WORLD)
    return true_world_of(World(load_world(path)))


@pytest.fixture(scope="module")
def bound(world):
    return LowerBound(world, 0.5, samples=300)


@pytest.fixture(scope="module")
def driving(world):
    return DrivingDistance(world)


def sees(world, place, points):
    """Which points (N, 2) are in line of sight and range of a place."""
    offsets = points - np.asarray(place)
    lengths = np.hypot(*offsets.T)
    reached = [world.cast(tuple(place), np.array([math.atan2(y, x)]), 8.0)[0] for x, y in offsets]
    return lengths < np.array(reached) - 1e-6


def value_at(field, driving, point):
    row, column = driving.lattice.index(np.array(point))
    return float(field[row, column])


def test_coverage_grows_to_everything(bound):
    shares = bound.coverage([START], np.linspace(0.0, 60.0, 121))
    assert (np.diff(shares) >= 0.0).all()
    assert shares[0] > 0.0
    assert shares[-1] == 1.0


def test_at_the_start_it_is_what_is_seen_from_there(world, bound):
    seen = sees(world, START[:2], bound.points).mean()
    assert seen <= bound.coverage([START], np.zeros(1))[0] <= seen + 0.1
    assert seen < 0.8


def test_speed_is_the_lower_one_of_base_and_navigation(world, bound):
    assert bound.speed == SPEED
    assert LowerBound(world, 0.3, samples=1).speed == 0.3


def test_no_straight_drive_sees_more(world, bound):
    """A robot that drives to the door and on to the far corner at full speed, looking all around all the time."""
    legs = [np.array(START[:2]), np.array(DOOR), np.array((9.5, 0.5))]
    seen = np.zeros(len(bound.points), dtype=bool)
    driven = 0.0
    for begin, end in itertools.pairwise(legs):
        length = math.dist(begin, end)
        for share in np.linspace(0.0, 1.0, 25):
            seen |= sees(world, begin + share * (end - begin), bound.points)
            time = (driven + share * length) / SPEED
            assert seen.mean() <= bound.coverage([START], np.array([time]))[0] + 1e-9
        driven += length
    assert seen.mean() > 0.97  # so that the test says something


def test_it_excludes_something(bound):
    """Nobody can see the far room at once."""
    halfway = math.dist(START[:2], DOOR) / SPEED / 2.0
    assert bound.coverage([START], np.array([halfway]))[0] < 0.95
    assert bound.completion_time([START]) > halfway


def test_more_robots_are_not_slower(bound):
    times = np.linspace(0.0, 30.0, 31)
    team = [START, (9.0, 1.0, 0.0)]
    assert (bound.coverage(team, times) >= bound.coverage([START], times)).all()
    assert bound.completion_time(team) < bound.completion_time([START])
    first_complete = times[np.argmax(bound.coverage(team, times) == 1.0)]
    assert bound.completion_time(team) >= first_complete - 1.0


def test_driving_distance_is_no_longer_than_the_way(driving):
    field = driving.from_start(START)
    for point in [(1.5, 1.0), (4.0, 3.0), (4.5, 1.82), (2.0, 3.5), DOOR]:
        straight = math.dist(START[:2], point)
        assert straight - 0.5 - 0.03 * straight <= value_at(field, driving, point) <= straight
    behind = (5.5, 0.5)
    round_the_wall = math.dist(START[:2], (4.95, 2.9)) + math.dist((5.05, 2.9), behind) + 0.1
    assert math.dist(START[:2], behind) + 0.5 < value_at(field, driving, behind) <= round_the_wall + 0.3


def test_driving_distance_in_every_direction(tmp_path):
    path = tmp_path / "hall.world"
    wide = WORLD.replace("size [ 0.1 2.9 1 ] pose [ 5 1.45 0 0 ]", "size [ 0.1 0.1 1 ] pose [ 5 0.1 0 0 ]")
    path.write_text(wide.replace("ranger ( pose [ 0.1 0 0 0 ]", "ranger ( pose [ 0 0 0 0 ]"))
    driving = DrivingDistance(true_world_of(World(load_world(path))))
    field = driving.from_start(START)
    for angle in np.radians([0.0, 5.0, 13.3, 17.0]):
        point = (START[0] + 8.4 * math.cos(angle), START[1] + 8.4 * math.sin(angle))
        assert 7.7 <= value_at(field, driving, point) <= 8.4


def test_starts_outside_are_refused(driving):
    with pytest.raises(ValueError, match=r"\(100, 1\) lies outside"):
        driving.from_start(Pose(100.0, 1.0, 0.0))


def test_views_stop_at_walls(world, driving):
    views = Views(world, driving.lattice)
    seen = views.of_point(np.array((1.0, 1.0))).whole(driving.lattice.shape)
    for point, visible in [((4.0, 3.0), True), ((0.3, 0.3), True), ((6.0, 1.0), False), ((9.0, 3.5), False)]:
        row, column = driving.lattice.index(np.array(point))
        assert seen[row, column] == visible
