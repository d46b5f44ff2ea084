"""Where the new map of a robot begins whose SLAM was started again."""

import pytest

from mr_grid import Pose
from mr_launch.map_starts import MapStarts
from mr_launch.nodes import NodeWatch
from mr_launch.reports import RobotReport
from mr_launch.robot_log import RobotLog, Sample
from mr_launch.truth import Track


def track():
    """Ahead at 0.5 m/s up to 20 s, then it stands."""
    made = Track()
    for second in range(41):
        made.add((float(second), float(second), 1.0 + 0.5 * min(second, 20), 2.0, 0.0, 0.0, 0.0, 0, 0))
    return made


def log(*poses):
    made = RobotLog()
    made.take(Sample(40.0), [{"kind": "pose", "at": at, "place": list(place)} for at, place in poses])
    return made


def report(stamp, begun=(0, 0)):
    """Of a map."""
    return RobotReport("robot_0", map_stamp=stamp, map_begun=None if begun is None else list(begun))


BEFORE, AFTER = (19.5, (9.75, 0.0, 0.0)), (24.0, (0.5, 0.0, 0.0))


@pytest.mark.parametrize("begun", [((5, 0), (23, 1)), ((0, 0), (0, 0)), ((19, 0), (23, 500_000_000)), (None, (0, 0))])
def test_it_begins_where_the_robot_stood(begun):
    starts, tracks = MapStarts(), {"robot_0": track()}
    starts.lose(report(19.0, begun[0]), 20.0)
    maps = {"robot_0": report(23.5, begun[1])}
    assert starts.found(maps, {"robot_0": log(BEFORE)}, tracks) == {}
    both = {"robot_0": log(BEFORE, AFTER)}
    assert starts.found({"robot_0": report(19.0, begun[0])}, both, tracks) == {}, "there is no new map yet"
    assert starts.found(maps, both, tracks) == {"robot_0": pytest.approx(Pose(10.5, 2.0, 0.0))}
    assert starts.found(maps, both, tracks) == {}, "each once"


def test_slam_that_goes_on_with_its_map_begins_none():
    starts, tracks = MapStarts(), {"robot_0": track()}
    starts.lose(report(19.0, (5, 0)), 20.0)
    for _ in range(2):
        assert starts.found({"robot_0": report(23.5, (5, 0))}, {"robot_0": log(BEFORE, AFTER)}, tracks) == {}


def test_what_the_trace_has_not_reached_is_waited_for():
    starts = MapStarts()
    starts.lose(report(37.0), 38.0)
    logs = {"robot_0": log((41.0, (0.0, 0.0, 0.0)))}
    assert starts.found({"robot_0": report(41.0)}, logs, {"robot_0": track()}) == {}


def test_an_end_of_slam_is_told_once(tmp_path):
    died = "[{}-5] process has died [pid 7, exit code -9, cmd x].\nlog file: /x*.log\n"
    watch = NodeWatch(tmp_path / "robot_0.log", respawns=True)
    (tmp_path / "robot_0.log").write_text(died.format("explorer"))
    assert watch.failures() == [] and not watch.take_lost_map()
    (tmp_path / "robot_0.log").write_text(died.format("explorer") + died.format("slam"))
    assert watch.failures() == [] and watch.take_lost_map() and not watch.take_lost_map()
