"""The SLAM node without a master: scans and odometry of different clocks, drivers that start."""

import threading
from collections import deque
from typing import List

import numpy as np
import pytest
import rospy
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from usual_robot import slam_with

from mr_grid import Pose
from mr_grid.ros_laser import Mount
from mr_robot.parameter_names import FRAMES
from mr_robot.slam import node as module
from mr_robot.slam.engine import OdometryHistory, SlamError
from mr_robot.slam.keeper import MapKeeper
from mr_robot.slam.node import SlamNode


class Broadcaster:
    """Keeps what was sent."""

    def __init__(self) -> None:
        self.sent: List[TransformStamped] = []

    def sendTransform(self, message: TransformStamped) -> None:
        self.sent.append(message)


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch) -> List[str]:
    """Warnings, each once."""
    texts: List[str] = []

    def warn(_: float, text: str) -> None:
        if text not in texts:
            texts.append(text)

    monkeypatch.setattr(rospy, "logwarn_throttle", warn)
    return texts


@pytest.fixture
def node(monkeypatch: pytest.MonkeyPatch) -> SlamNode:
    made = SlamNode.__new__(SlamNode)
    made._slam, made._odometry, made._waiting, made._mounts = (
        slam_with(),
        OdometryHistory(),
        deque(maxlen=40),
        {"laser": Mount()},
    )
    made._transformed_at, made._transform_period = -float("inf"), 0.1
    monkeypatch.setattr(rospy, "get_param", lambda name, default: default)
    made._keeper = MapKeeper(made._slam, made._odometry)
    made._frames, made._tolerance = FRAMES, rospy.Duration(0.2)
    made._published_at, made._map_interval = -float("inf"), 2.0
    monkeypatch.setattr(made, "_publish_map", lambda stamp: None)
    made._broadcaster = Broadcaster()
    made._lock = threading.Lock()
    return made


def odometry(time: float, x: float = 0.0) -> Odometry:
    message = Odometry()
    message.pose.pose.position.x = x
    message.header.stamp = rospy.Time.from_sec(time)
    message.pose.pose.orientation.w = 1.0
    return message


def scan(time: float, x: float = 0.0) -> LaserScan:
    """From `x` in a room of 8 m x 8 m."""
    angles = -3.14 + 0.0174 * np.arange(360)
    ahead = np.where(np.cos(angles) > 0.0, 4.0 - x, 4.0 + x) / np.abs(np.cos(angles))
    ranges = np.minimum(ahead, 4.0 / np.abs(np.sin(angles)))
    message = LaserScan(angle_min=-3.14, angle_increment=0.0174, range_min=0.1, range_max=30.0, ranges=ranges)
    message.header.frame_id, message.header.stamp = "laser", rospy.Time.from_sec(time)
    return message


@pytest.mark.parametrize(("ahead", "words"), [(0.0, ""), (5.0, "+"), (-8.0, "-")])
def test_clocks_that_are_apart_are_told(node: SlamNode, said: List[str], ahead: float, words: str) -> None:
    """There was no map, and nothing was said."""
    for step in range(120):
        time = 1000.0 + 0.05 * step
        node._on_odometry(odometry(time))
        node._on_scan(scan(time + ahead - 0.02))
    assert (node._slam.revision > 0) == (not words)
    assert (len(said) > 0) == bool(words) and all(text.startswith(f"scan is dated {words}") for text in said)


def test_scans_wait_for_odometry_that_comes_later_than_the_next_one(node: SlamNode) -> None:
    """Each took the place of the one before, and none was ever used."""
    used = []
    process = node._slam.process
    node._slam.process = lambda *arguments: used.append(arguments[2]) or process(*arguments)  # type: ignore[method-assign]
    for step in range(200):
        if step % 2 == 0:
            node._on_odometry(odometry(1000.0 + 0.025 * step - 0.06))
        node._on_scan(scan(1000.0 + 0.025 * step))
    assert len(used) > 190 and used == sorted(used)


def test_a_scan_that_cannot_be_used_holds_up_no_other(node: SlamNode) -> None:
    node._on_odometry(odometry(1000.0))
    bad = scan(1000.05)
    bad.range_max = 0.0
    for message in (bad, scan(1000.06)):
        node._on_scan(message)
    with pytest.raises(SlamError):
        node._on_odometry(odometry(1000.1))
    node._on_odometry(odometry(1000.15))
    assert not node._waiting and node._slam.revision


def test_scans_of_a_clock_that_was_set_back_do_not_wait_behind_those_before(node: SlamNode, said: List[str]) -> None:
    node._on_odometry(odometry(1000.0))
    node._on_scan(scan(1000.5))
    for step in range(10):
        node._on_odometry(odometry(10.0 + 0.1 * step))
        node._on_scan(scan(10.0 + 0.1 * step - 0.05))
    assert node._slam.revision and not node._waiting


def test_odometry_is_kept_for_as_long_at_any_rate() -> None:
    """A hundred messages of a driver at 1 kHz were less than the time of a scan."""
    fast, slow = OdometryHistory(), OdometryHistory()
    for step in range(8000):
        fast.add(0.001 * step, Pose(0.0001 * step, 0.0, 0.0))
    for step in range(200):
        slow.add(0.2 * step, Pose(0.01 * step, 0.0, 0.0))
    assert fast.at(5.5) is not None and fast.at(4.0) is None and len(fast._times) <= 4000
    assert slow.at(30.0) is not None


def test_odometry_out_of_order_is_passed_over() -> None:
    """It was taken for a clock that was set back, and all before it was forgotten."""
    history = OdometryHistory()
    for time in (10.0, 10.1, 10.09, 10.2):
        assert history.add(time, Pose(time, 0.0, 0.0))
    assert list(history._times) == [10.0, 10.1, 10.2]
    history.add(2.0, Pose(0.0, 0.0, 0.0))
    assert list(history._times) == [2.0]


def test_odometry_of_another_world_after_the_clock_was_set_back_makes_no_map_of_that_size() -> None:
    """It was believed without a look, and the map from here to there did not fit into memory."""
    history = OdometryHistory()
    history.add(100.0, Pose(3.0, 0.0, 0.0))
    assert not history.add(1.0, Pose(1e9, 0.0, 0.0))
    assert history.newest() == (1.0, pytest.approx(Pose(3.0, 0.0, 0.0)))
    assert history.add(1.1, Pose(1e9, 0.0, 0.0)) and history.add(0.0, Pose(1e9 + 20.0, 0.0, 0.0))


def test_a_driver_of_the_wheels_that_begins_anew_moves_no_robot(node: SlamNode, said: List[str]) -> None:
    for step in range(40):
        node._on_odometry(odometry(1000.0 + 0.05 * step, 0.02 * step))
        node._on_scan(scan(1000.0 + 0.05 * step - 0.02, 0.02 * step - 0.008))
    assert not said
    for step in range(20):
        node._on_odometry(odometry(1004.0 + 0.05 * step))
        node._on_scan(scan(1004.0 + 0.05 * step - 0.02, 0.78))
        robot = node._broadcaster.sent[-1].transform.translation.x
        assert robot == pytest.approx(0.78, abs=0.02), "also right after it"
    assert said == [
        "odometry has jumped to (0.0, 0.0), as of a driver that begins anew: the robot is taken not to have moved"
    ]


def test_something_too_far_away_to_be_drawn_is_told_once_with_the_remedy(
    node: SlamNode, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: List[str] = []
    monkeypatch.setattr(rospy, "logwarn_once", told.append)
    for step in range(10):
        message = scan(1000.0 + 0.05 * step - 0.02)
        if step == 5:
            message.range_max = 300.0
            message.ranges[7] = 150.0
        node._on_odometry(odometry(1000.0 + 0.05 * step))
        node._on_scan(message)
    (text,) = told
    assert "something 150 m away; from 80 m on" in text and "a larger ~resolution reaches farther" in text


def test_while_drivers_start_nothing_is_said_of_the_lasers_place(
    node: SlamNode, said: List[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Nothing:
        def lookup_transform(self, *arguments: object) -> None:
            raise module.tf2_ros.TransformException("no laser")

    now = [10.0]
    monkeypatch.setattr(module.tf2_ros, "TransformListener", lambda buffer: object())
    monkeypatch.setattr(rospy, "get_time", lambda: now[0])
    node._mounts, node._buffer, node._listener = {}, Nothing(), None
    for moment in (10.0, 14.5):
        now[0] = moment
        assert node._mount("laser") is None
    assert said == []
    now[0] = 15.0
    assert node._mount("laser") is None
    assert said == ["no transform from base_footprint to the laser yet: no laser"]


def test_a_message_that_comes_while_the_node_ends_is_no_traceback(
    node: SlamNode, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its publishers are closed then; Ctrl-C left a traceback for each robot that had just heard of its wheels."""

    def publishing(_: Odometry) -> None:
        raise rospy.ROSException("publish() to a closed topic")

    guarded = node._guard(publishing)
    monkeypatch.setattr(rospy.core, "is_shutdown_requested", lambda: True)
    guarded(Odometry())
    monkeypatch.setattr(rospy.core, "is_shutdown_requested", lambda: False)
    with pytest.raises(rospy.ROSException):
        guarded(Odometry())


@pytest.mark.parametrize("value", [float("inf"), float("nan"), 1.0e300, -0.1, True, "0.2"])
def test_what_is_no_time_of_ros_is_refused_with_a_sentence(monkeypatch: pytest.MonkeyPatch, value: object) -> None:
    """`.inf` ended the node with a traceback."""
    monkeypatch.setattr(rospy, "get_param", lambda name, default: value)
    with pytest.raises(SlamError, match="parameter ~transform_tolerance must be a number from 0 to 1e\\+06, not "):
        module.number_parameter("transform_tolerance", 0.2)
