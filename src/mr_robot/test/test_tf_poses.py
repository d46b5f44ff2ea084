"""Scan and pose of different moments, as tf and a laser's driver give them."""

import math
import threading
from types import SimpleNamespace
from typing import Any, List, Optional, Tuple

import numpy as np
import pytest
import rospy
import tf2_ros
from geometry_msgs.msg import Quaternion, TransformStamped, Twist
from sensor_msgs.msg import LaserScan
from usual_robot import slam_with

from mr_grid import Pose
from mr_grid.ros import quaternion
from mr_grid.ros_laser import Mount
from mr_robot.navigation import ros_io as navigation_io
from mr_robot.navigation.dates import Dates
from mr_robot.navigation.node import MoveBaseNode
from mr_robot.navigation.tf_poses import TfPoses
from mr_robot.parameter_names import FRAMES
from mr_robot.ros_poses import ParameterError, frame_parameters, topic_parameters
from mr_robot.slam import ros_io as slam_io
from mr_robot.slam.node import SlamNode

MOUNT = Pose(0.1, 0.05, 0.3)
TURNING = 1.5  # rad/s
SPEED = 0.5  # m/s


def transform(parent: str, child: str, pose: Pose, time: float) -> TransformStamped:
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id = parent, child
    message.header.stamp = rospy.Time.from_sec(time)
    message.transform.translation.x, message.transform.translation.y = pose.x, pose.y
    message.transform.rotation = quaternion(pose.yaw)
    return message


def odometry(time: float) -> Pose:
    radius, angle = SPEED / TURNING, TURNING * (time - 10.0)
    return Pose(2.0 + radius * math.sin(angle), 1.0 + radius * (1.0 - math.cos(angle)), angle)


@pytest.fixture
def poses() -> TfPoses:
    """Of a robot on an arc from 10 s to 11 s, odometry each 0.1 s; SLAM says that odometry is 1 m off."""
    rospy.rostime.switch_to_wallclock()
    rospy.rostime.set_rostime_initialized(True)
    buffer = tf2_ros.Buffer(rospy.Duration(10.0), debug=False)
    buffer.set_transform_static(transform("base_footprint", "laser", MOUNT, 0.0), "test")
    for step in range(11):
        time = 10.0 + 0.1 * step
        buffer.set_transform(transform("map", "odom", Pose(1.0, 0.0, 0.0), time + 0.2), "test")
        buffer.set_transform(transform("odom", "base_footprint", odometry(time), time), "test")
    buffer.set_transform(transform("map", "odom", Pose(1.0, 0.0, 0.0), 10.0), "test")
    return TfPoses(buffer, FRAMES, Dates(0.1))


def test_what_a_turning_robot_saw_a_moment_ago_stays_where_it_was(poses: TfPoses) -> None:
    pose, stamp = poses.robot(11.05) or pytest.fail("no pose")
    assert pose == pytest.approx(Pose(1.0, 0.0, 0.0).compose(odometry(11.0)))
    laser = poses.laser("laser", rospy.Time.from_sec(10.8), stamp)
    assert laser is not None
    assert odometry(11.0).compose(laser.pose) == pytest.approx(odometry(10.8).compose(MOUNT), abs=1e-6)
    assert abs(laser.pose.yaw - MOUNT.yaw) == pytest.approx(0.3, abs=1e-6)


def test_a_scan_from_before_or_after_all_odometry_is_taken_as_mounted(poses: TfPoses) -> None:
    for taken in (9.0, 11.04):
        laser = poses.laser("laser", rospy.Time.from_sec(taken), rospy.Time.from_sec(11.0))
        assert laser is not None and laser.pose == pytest.approx(MOUNT)


def test_an_old_pose_one_of_the_future_and_an_unknown_laser_are_none(poses: TfPoses) -> None:
    assert poses.robot(11.6) is None
    assert poses.robot(10.6) is not None and poses.robot(10.4) is None
    assert poses.laser("camera", rospy.Time.from_sec(10.8), rospy.Time.from_sec(11.0)) is None


def test_a_scan_of_the_future_is_none(poses: TfPoses, monkeypatch: pytest.MonkeyPatch) -> None:
    """A robot drove on by the last scan of a laser whose clock ran ahead, for as long as it did."""
    said: List[str] = []
    monkeypatch.setattr(rospy, "logwarn_throttle", lambda _, text: said.append(text))
    node = MoveBaseNode.__new__(MoveBaseNode)
    node._tf_poses, node._scan = poses, seen_upside_down(0.0)
    node._scan.header.frame_id = "laser"
    node._scan.header.stamp = stamp = rospy.Time.from_sec(11.0)
    assert node._scan_value(10.6, stamp) is not None and not said
    for step in range(35):
        assert node._scan_value(7.0 + 0.1 * step, stamp) is None
    assert said[0].startswith("scan ignored: dated 1.5 s ahead") and said[0].endswith("must have one clock")
    told = len(said)
    assert node._scan_value(11.6, stamp) is None and len(said) == told


def test_what_fails_in_a_control_period_stops_the_robot_and_ends_no_control(monkeypatch: pytest.MonkeyPatch) -> None:
    """It ended the thread of the timer: no command came any more, and goals stayed active for ever."""
    said: List[str] = []
    monkeypatch.setattr(rospy, "logerr", said.append)
    monkeypatch.setattr(rospy, "get_time", lambda: 1.0)
    node, sent, aborted = MoveBaseNode.__new__(MoveBaseNode), [], []
    node._dates = Dates(0.1)
    node._lock, node._moving, node._navigator = threading.RLock(), True, SimpleNamespace(cancel=lambda: None)
    node._command = SimpleNamespace(publish=sent.append)
    node._server = SimpleNamespace(
        is_new_goal_available=lambda: False, is_preempt_requested=lambda: False, is_active=lambda: True,
        set_aborted=lambda _, text: aborted.append(text),
    )  # fmt: skip
    monkeypatch.setattr(node, "_control", lambda now: [][0])
    for _ in range(2):
        node._on_timer(None)
    assert sent == [Twist(), Twist()] and aborted == 2 * ["navigation failed: list index out of range"]
    assert len(said) == 2 and "Traceback" in said[0] and not node._moving


class Unused:
    """In place of a listener."""

    def unregister(self) -> None:
        pass


def mounts(rotation: Quaternion, frame: str = "laser") -> Tuple[Optional[Mount], Optional[Mount]]:
    """That of a laser so mounted for navigation, and for SLAM. `frame`: as its scans name it."""
    message = transform("base_footprint", "laser", Pose(), 0.0)
    message.transform.rotation = rotation
    buffer = tf2_ros.Buffer(debug=False)
    buffer.set_transform_static(message, "test")
    slam = SlamNode.__new__(SlamNode)
    slam._mounts, slam._frames, slam._buffer, slam._listener = {}, FRAMES, buffer, Unused()
    time = rospy.Time.from_sec(1.0)
    return TfPoses(buffer, FRAMES, Dates(0.1)).laser(frame, time, time), slam._mount(frame)


def seen_upside_down(yaw: float) -> LaserScan:
    """From the middle of a room of 8 m x 8 m, but for the wall to the left, which is 1 m away."""
    angles = -math.pi + 2.0 * math.pi / 360 * np.arange(360)
    x, y = np.cos(yaw - angles), np.sin(yaw - angles)
    with np.errstate(divide="ignore"):
        ranges = np.minimum(4.0 / np.abs(x), np.where(y > 0.0, 1.0, 7.0) / np.abs(y)).astype(np.float32)
    return LaserScan(
        angle_min=-math.pi, angle_increment=2.0 * math.pi / 360, range_min=0.1, range_max=30.0, ranges=ranges
    )


def test_a_laser_that_hangs_upside_down_sees_on_its_left_what_is_there() -> None:
    """Navigation kept off walls on the other side, and SLAM turned the other way."""
    navigation, slam = mounts(Quaternion(1.0, 0.0, 0.0, 0.0))
    assert navigation is not None and slam is not None
    points = navigation_io.scan_value(seen_upside_down(0.0), navigation).points
    near = points[np.hypot(points[:, 0], points[:, 1]) < 1.05]
    assert len(near) and near[:, 1] == pytest.approx(1.0, abs=1e-6)
    engine = slam_with()
    for step in range(40):
        yaw = 0.05 * step
        scan = slam_io.scan_value(seen_upside_down(yaw), slam)
        update = engine.process(scan, Pose(0.0, 0.0, yaw), 0.1 * step)
        assert update.matched and update.pose == pytest.approx((0.0, 0.0, yaw), abs=0.05)


def test_a_tilted_laser_is_refused_with_its_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    said: List[str] = []
    monkeypatch.setattr(rospy, "logwarn_throttle", lambda _, text: said.append(text))
    assert mounts(Quaternion(math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))) == (None, None)
    assert len(said) == 2 and all("laser laser is tilted by 90 degrees" in text for text in said)


def test_frames_may_begin_with_a_slash(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drivers of ROS 1 name them so; tf2 does not take such names, and their laser was never found."""
    assert mounts(Quaternion(0.0, 0.0, 0.0, 1.0), "/laser") == (Mount(), Mount())
    monkeypatch.setattr(rospy, "get_param", {"~map_frame": "/map", "~odom_frame": "r1/odom"}.get)
    assert frame_parameters(FRAMES) == {"map_frame": "map", "odom_frame": "r1/odom", "base_frame": "base_footprint"}


@pytest.mark.parametrize("topic", [5, "", "my scan", True, ["scan"]])
def test_what_no_topic_can_be_named_is_refused_with_its_parameter(monkeypatch: pytest.MonkeyPatch, topic: Any) -> None:
    """rospy raised a TypeError that told neither node nor parameter."""
    monkeypatch.setattr(rospy, "get_param", {"~scan_topic": topic}.get)
    with pytest.raises(ParameterError, match="parameter ~scan_topic must be the name of a topic, not "):
        topic_parameters({"scan_topic": "base_scan"})
    assert topic_parameters({"velocity_topic": "/cmd_vel"}) == {"velocity_topic": "/cmd_vel"}
