"""Whether the map frame is another one, from what tf tells."""

import math

import pytest

from mr_grid import Pose
from mr_grid.map_frame import MapFrame, MapRuns, run_named

OLD = Pose(1.0, 2.0, 0.5)


def frame(base="base_footprint", **arguments):
    made = MapFrame("map", base, **arguments)
    for parent, child in (("odom", "base_footprint"), ("base_footprint", "base_link"), ("map", "odom")):
        made.link(parent, child)
    return made


def test_slam_that_goes_on_moves_no_frame():
    followed = frame()
    assert followed.take("slam a", "odom", OLD, 10.0) is None
    assert followed.take("slam a", "odom", Pose(3.0, 2.0, 0.4), 100.0) is None
    assert followed.teller == "slam a"


def test_another_process_that_goes_on_with_the_map_moves_no_frame_either():
    followed = frame()
    followed.take("slam a", "odom", OLD, 10.0)
    assert (
        followed.take("slam b", "odom", Pose(OLD.x + 0.003, OLD.y, OLD.yaw), 13.0) is None
        and followed.teller == "slam b"
    )
    assert followed.take("slam c", "odom", Pose(OLD.x + 0.1, OLD.y, OLD.yaw), 16.0) is not None


def test_another_process_has_another_frame_and_odometry_ties_the_two():
    followed, robot = frame(), Pose(4.0, -1.0, 2.0)  # in the frame of the odometry
    place = OLD.compose(robot)
    followed.take("slam a", "odom", OLD, 10.0)
    new = followed.take("slam b", "odom", robot.inverse(), 13.0)  # it begins where the robot is
    assert new.until == 10.0 and new.shift.compose(place) == pytest.approx(Pose())
    assert followed.take("slam b", "odom", robot.inverse(), 13.1) is None


def test_without_odometry_nothing_ties_them():
    followed = MapFrame("map", "base_link")
    followed.link("map", "base_link")
    followed.take("slam a", "base_link", OLD, 10.0)
    assert followed.take("slam b", "base_link", Pose(), 13.0).shift is None


def test_one_that_was_known_before_this_process_began_ties_nothing_either():
    followed = frame(teller="slam a")
    assert followed.take("slam b", "odom", Pose(), 0.1).shift is None
    assert frame(teller="slam a").take("slam a", "odom", Pose(), 0.1) is None


def test_two_that_tell_at_the_same_time_are_no_restart():
    followed = frame()
    for number in range(100):
        assert followed.take("ab"[number % 2], "odom", OLD, 10.0 + 0.1 * number) is None


def test_a_clock_that_was_set_back_hides_no_restart():
    followed = frame()
    followed.take("slam a", "odom", OLD, 100.0)
    assert followed.take("slam b", "odom", Pose(), 3.0).shift == pytest.approx(OLD.inverse())


def test_only_the_way_to_the_robot_counts():
    followed = frame("base_link")
    followed.link("map", "robot_1/map")
    followed.link("robot_1/map", "robot_1/odom")
    assert followed.is_way("odom")
    assert not followed.is_way("robot_1/map") and not followed.is_way("base_link")
    assert not frame("").is_way("odom") and not MapFrame("map", "base_link").is_way("odom")


def test_a_ring_of_frames_is_no_way():
    followed = MapFrame("map", "a")
    followed.link("b", "a")
    followed.link("a", "b")
    assert not followed.is_way("a")


def test_maps_of_the_former_frame_are_told_from_those_of_the_new_one():
    runs = MapRuns()
    assert runs.take((5, 1), 10.0) and runs.take((5, 1), 12.0)
    runs.begin(13.0)
    assert not runs.take((5, 1), 13.5) and runs.take((9, 1), 16.0) and runs.take((9, 1), 18.0)
    assert not runs.take((5, 1), 19.0)


def test_a_map_of_the_new_frame_may_come_before_tf_says_that_it_is_one():
    """Threads of a busy computer."""
    runs = MapRuns()
    assert runs.take((5, 1), 10.0) and runs.take((9, 1), 16.0)
    runs.begin(13.0)
    assert runs.take((9, 1), 18.0)


def test_maps_without_a_run_are_taken():
    runs = MapRuns()
    assert runs.take(None, 10.0)
    runs.begin(13.0)
    assert runs.take(None, 13.1)


@pytest.mark.parametrize(
    ("load_time", "stamp", "run"),
    [
        ((1_700_000_000, 5), 40.0, (1_700_000_000, 5)),
        ((30, 0), 40.0, (30, 0)),
        ((40, 0), 40.0, None),  # a stamp
        ((0, 0), 40.0, None),
    ],
)
def test_a_load_time_that_is_a_stamp_names_no_run(load_time, stamp, run):
    assert run_named(load_time, stamp) == run


def test_a_shift_turns():
    followed = frame()
    followed.take("a", "odom", Pose(0.0, 0.0, math.pi / 2.0), 1.0)
    assert followed.take("b", "odom", Pose(), 9.0).shift == pytest.approx(Pose(0.0, 0.0, -math.pi / 2.0))
