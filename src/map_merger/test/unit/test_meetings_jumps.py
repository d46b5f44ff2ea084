"""Meetings of robots whose SLAM jumps."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from meeting_scene import NARROW, Actor, Scene, driving, room, standing

from map_merger.meetings.jumps import jumps_of
from map_merger.transform import displacement, rotation_between
from mr_grid import Pose

WALLS = room(14.0, 11.0)
CENTRE = np.zeros((1, 2))


def drive(seconds=12.0, period=0.2):
    """A track (n, 4) of a robot that starts and stops, turns on the spot and drives curves, as fast as one can."""
    times = np.arange(0.0, seconds, period)
    speed = np.clip(np.minimum(times - 1.0, 5.0 - times), 0.0, 0.5)
    rate = np.where(times < 5.0, 0.5 * np.sin(times), np.clip(2.0 * (times - 6.0), 0.0, 1.5))
    yaw = np.cumsum(rate) * period
    places = np.cumsum(speed * np.exp(1j * yaw)) * period
    return np.column_stack([times, places.real, places.imag, yaw])


def jumped(track, index, jump):
    later = track.copy()
    for row in later[index:]:
        row[1:] = jump.compose(Pose(*row[1:]))
    return later


@pytest.mark.parametrize("period", [0.1, 0.2])
def test_starts_stops_and_turns_are_no_jumps(period):
    found = jumps_of(drive(period=period))
    assert not len(found.times) and found.size == 0.0
    assert found.mean_frame(drive()) == Pose()


@given(
    st.integers(3, 56), st.floats(0.2, 0.6), st.floats(-math.pi, math.pi), st.floats(math.radians(-8), math.radians(8))
)
def test_what_was_before_a_jump_is_carried_along(index, distance, direction, turn):
    smooth = drive()
    here = Pose(*smooth[index - 1, 1:])
    jump = here.compose(Pose(distance * math.cos(direction), distance * math.sin(direction), turn)).compose(
        here.inverse()
    )
    found = jumps_of(jumped(smooth, index, jump))
    assert len(found.times) == 1 and smooth[index - 1, 0] < found.times[0] < smooth[index, 0]
    assert abs(found.size - distance) < 0.06
    steady = found.steady(jumped(smooth, index, jump))
    # The track is all in the frame after the jump, but for what the robot may have turned meanwhile.
    wanted = jumped(smooth, 0, jump)
    assert np.abs(steady[index:, 1:] - wanted[index:, 1:]).max() < 1e-9
    assert np.hypot(*(steady[index - 1, 1:3] - wanted[index - 1, 1:3])) < 0.08
    assert abs(math.remainder(steady[index - 1, 3] - wanted[index - 1, 3], 2.0 * math.pi)) < 0.2


def test_the_frame_of_the_map_is_that_of_most_of_the_time():
    track = np.column_stack([np.arange(0.0, 20.0, 0.2), np.zeros((100, 3))])
    late = jumps_of(jumped(track, 95, Pose(0.4, 0.0, 0.0)))
    early = jumps_of(jumped(track, 5, Pose(0.4, 0.0, 0.0)))
    assert late.mean_frame(jumped(track, 95, Pose(0.4, 0.0, 0.0))).x == pytest.approx(-0.38, abs=0.01)
    assert early.mean_frame(jumped(track, 5, Pose(0.4, 0.0, 0.0))).x == pytest.approx(-0.02, abs=0.01)


@pytest.mark.parametrize("who", ["a", "b"])
def test_a_jump_of_either_slam_in_the_middle_of_a_meeting_does_not_spoil_it(who):
    def weave(time):
        return 0.5 * math.sin(0.9 * time)

    jump = Pose(0.3, -0.25, math.radians(3.0))
    scene = Scene(
        [Actor("a", standing(-3.0, 0.0), view=NARROW), Actor("b", driving(-1.0, -0.4, 1.2, 0.2, weave), view=NARROW)],
        WALLS,
        jumps={who: (5.0, jump)},
    )
    scene.run(9.0)
    hypotheses = scene.hypotheses("a", "b")
    assert hypotheses and hypotheses[0].settled, scene.meetings["a"].why("b")
    found = hypotheses[0]
    # The map is in the frame before the jump for a part, and in that after it for the rest.
    before = scene.truth("b", "a")
    after = jump.compose(before) if who == "a" else before.compose(jump.inverse())
    between = displacement(before, after, CENTRE)[0]
    assert displacement(found.transform, before, CENTRE)[0] < between + 0.1
    assert displacement(found.transform, after, CENTRE)[0] < between + 0.1
    assert rotation_between(found.transform, before) < math.radians(7.0)
    # How far off it may be for that is told, so that walls decide.
    assert math.sqrt(found.covariance[0, 0]) > 0.15


def test_robots_that_face_one_another_need_no_turn():
    ways = {"a": standing(-2.0, 0.0), "b": driving(1.0, -0.3, 3.0, 0.2)}
    facing = Scene([Actor(name, way, view=NARROW) for name, way in ways.items()], WALLS).run(9.0)
    found = facing.hypotheses("a", "b")
    assert found[0].settled and found[0].bend < 0.12
    assert displacement(found[0].transform, facing.truth("b", "a"), CENTRE)[0] < 0.15
    backwards = {"a": standing(-2.0, 0.0), "b": driving(-0.7, -0.3, 0.1, 0.2)}
    behind = Scene([Actor(name, way, view=NARROW) for name, way in backwards.items()], WALLS).run(9.0)
    assert not any(each.settled for each in behind.hypotheses("a", "b"))
    assert behind.meetings["a"].why("b").startswith("waits to see b turn")
