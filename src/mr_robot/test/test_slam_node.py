"""The SLAM node without a master: scans and odometry of different clocks, drivers that start."""

from typing import List

import numpy as np
import pytest
import rospy
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from mr_grid.ros_laser import Mount
from mr_robot.parameter_names import FRAMES
from mr_robot.slam import node as module
from mr_robot.slam.engine import OdometryHistory, Slam
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
    made._slam, made._odometry, made._pending, made._mounts = Slam(), OdometryHistory(), None, {"laser": Mount()}
    made._transformed_at, made._transform_period = -float("inf"), 0.1
    made._frames, made._tolerance = FRAMES, rospy.Duration(0.2)
    made._published_at, made._map_interval = -float("inf"), 2.0
    monkeypatch.setattr(made, "_publish_map", lambda stamp: None)
    made._broadcaster = Broadcaster()
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
