"""Poses and scans from ROS. They need ROS's message classes, but no master."""

import io

import pytest

pytest.importorskip("rospy")

import numpy as np
import rospy
from adhoc_communication.msg import MmMapUpdate
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from map_merger import ros_inputs, ros_io


class Buffer:
    """A robot that has moved on since its scan."""

    def lookup_transform(self, target, source, time, timeout=None):
        transform = TransformStamped()
        transform.transform.rotation.w = 1.0
        transform.transform.translation.x = time.to_sec()
        return transform


def raw_of(message):
    raw, octets = rospy.AnyMsg(), io.BytesIO()
    message.serialize(octets)
    raw._buff = octets.getvalue()
    return raw


def test_a_map_update_of_the_original_tells_neither_resolution_nor_orientation():
    """Of its tiles it fills in header, offset, width and height; each was refused for its resolution."""
    update = MmMapUpdate(src_robot="bob", update_numbers=[3])
    update.map.header.frame_id, update.map.header.seq = "bob", 3
    update.map.info.width, update.map.info.height = 3, 2
    update.map.info.origin.position.x, update.map.info.origin.position.y = 100.0, 200.0
    update.map.data = [0, 100, -1, 0, 0, 0]
    tile = ros_io.tile_of(update)
    assert (tile.row, tile.column, tile.cells.tolist()) == (100, 200, [[0, 100, -1], [0, 0, 0]])
    assert tile.resolution == 0.0 and not tile.whole


def test_a_pose_comes_with_the_stamp_of_its_odometry(monkeypatch):
    """Dated when it was looked at, between scans dated rightly, a turning robot seemed to jump to and fro: transforms
    that were right were taken to be refuted."""
    monkeypatch.setattr(ros_inputs.rospy, "Subscriber", lambda *arguments, **options: None)
    monkeypatch.setattr(ros_inputs.rospy, "get_time", lambda: 7.3)
    poses = ros_inputs.PoseInput("odom", "odom", Buffer())
    message = Odometry(child_frame_id="base")
    message.header.frame_id, message.header.stamp = "odom", rospy.Time(7, 0)
    message.pose.pose.position.x, message.pose.pose.orientation.w = 2.0, 1.0
    poses._keep(raw_of(message))
    pose, stamp = poses.take()
    assert (pose.x, stamp) == (2.0, 7.0) and poses.take() is None


def test_a_scan_comes_with_its_stamp_and_the_pose_of_that_time(monkeypatch):
    """It was dated when it had been processed, up to 0.3 s late."""
    monkeypatch.setattr(ros_inputs.rospy, "Subscriber", lambda *arguments, **options: None)
    monkeypatch.setattr(ros_inputs.rospy, "get_time", lambda: 7.3)
    taken = []
    scans = ros_inputs.ScanInput(
        "scan", "map", Buffer(), lambda: "base", lambda: True, lambda *arguments: taken.append(arguments)
    )
    message = LaserScan(angle_min=-1.0, angle_increment=0.5, range_max=5.0, ranges=[1.0] * 5)
    message.header.frame_id, message.header.stamp = "laser", rospy.Time(7, 0)
    scans._on_scan(raw_of(message))
    ((scan, pose, stamp),) = taken
    assert scan.ranges.size == 5 and pose.x == 7.0 and stamp == 7.0


def test_the_beams_of_a_laser_that_hangs_upside_down_run_the_other_way_round():
    """Others were looked for in a mirror image of what was seen."""
    transform = TransformStamped()
    transform.transform.translation.x, transform.transform.rotation.x = 0.2, 1.0
    message = LaserScan(angle_min=0.5, angle_increment=0.25, range_max=5.0, ranges=[1.0, 2.0, 3.0])
    scan = ros_io.scan_of(message, ros_io.mount_of(transform))
    assert (scan.angle_min, scan.angle_increment, scan.mount) == (-0.5, -0.25, (0.2, 0.0, 0.0))


def test_scans_of_a_tilted_laser_are_ignored_with_its_frame(monkeypatch):
    said = []

    class Tilted(Buffer):
        def lookup_transform(self, target, source, time, timeout=None):
            transform = super().lookup_transform(target, source, time, timeout)
            transform.header.frame_id, transform.child_frame_id = target, source
            transform.transform.rotation.x = transform.transform.rotation.w = np.sqrt(0.5)
            return transform

    monkeypatch.setattr(ros_inputs.rospy, "Subscriber", lambda *arguments, **options: None)
    monkeypatch.setattr(ros_inputs.rospy, "get_time", lambda: 7.3)
    monkeypatch.setattr(ros_inputs.rospy, "logwarn_throttle", lambda _, text: said.append(text))
    scans = ros_inputs.ScanInput("scan", "map", Tilted(), lambda: "base", lambda: True, pytest.fail)
    message = LaserScan(angle_min=-1.0, angle_increment=0.5, range_max=5.0, ranges=[1.0] * 5)
    message.header.frame_id = "laser"
    scans._on_scan(raw_of(message))
    assert len(said) == 1 and "laser laser is tilted by 90 degrees" in said[0]


class Nothing:
    """SLAM that has no map yet."""

    def lookup_transform(self, *arguments):
        raise ros_inputs.tf2_ros.TransformException("no map yet")


def scans_that_are_not_placed():
    scans = ros_inputs.ScanInput("scan", "map", Nothing(), lambda: "base", lambda: True, lambda *_: None)
    raw = raw_of(LaserScan(ranges=[1.0]))
    return lambda: scans._on_scan(raw)


def poses_that_are_not_placed():
    poses = ros_inputs.PoseInput("odom", "map", Nothing())
    raw = raw_of(Odometry())

    def take():
        poses._keep(raw)
        assert poses.take() is None

    return take


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (scans_that_are_not_placed, "map_merger cannot place its scans yet: no map yet"),
        (poses_that_are_not_placed, "map_merger does not know its position yet: no map yet"),
    ],
    ids=["scans", "poses"],
)
def test_while_slam_starts_nothing_is_said_of_its_transforms(monkeypatch, made, words):
    said, now = [], [10.0]
    monkeypatch.setattr(ros_inputs.rospy, "Subscriber", lambda *arguments, **options: None)
    monkeypatch.setattr(ros_inputs.rospy, "get_time", lambda: now[0])
    monkeypatch.setattr(ros_inputs.rospy, "logwarn", said.append)
    monkeypatch.setattr(ros_inputs.rospy, "logwarn_throttle", lambda _, text: said.append(text))
    come = made()
    for moment in (10.0, 12.0, 14.5):
        now[0] = moment
        come()
    assert said == []
    now[0] = 15.5
    come()
    assert said == [words]
