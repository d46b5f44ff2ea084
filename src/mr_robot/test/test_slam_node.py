"""What the SLAM node makes of scans and odometry of different clocks, without a master."""

from typing import List

import pytest
import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from mr_grid.ros_laser import Mount
from mr_robot.slam.engine import OdometryHistory, Slam
from mr_robot.slam.node import SlamNode


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
    made._published_at, made._map_interval = -float("inf"), 2.0
    monkeypatch.setattr(made, "_publish_map", lambda stamp: None)
    monkeypatch.setattr(made, "_publish_transform", lambda stamp: None)
    return made


def odometry(time: float) -> Odometry:
    message = Odometry()
    message.header.stamp = rospy.Time.from_sec(time)
    message.pose.pose.orientation.w = 1.0
    return message


def scan(time: float) -> LaserScan:
    message = LaserScan(angle_min=-3.14, angle_increment=0.0174, range_min=0.1, range_max=30.0, ranges=[4.0] * 360)
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
