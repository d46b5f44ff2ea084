"""Scan and pose of different moments, as tf and a laser's driver give them."""

import math

import pytest
import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped

from mr_grid import Pose
from mr_grid.ros import quaternion
from mr_robot.navigation.tf_poses import TfPoses

FRAMES = {"map_frame": "map", "odom_frame": "odom", "base_frame": "base_footprint"}
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
    return TfPoses(buffer, FRAMES)


def test_what_a_turning_robot_saw_a_moment_ago_stays_where_it_was(poses: TfPoses) -> None:
    pose, stamp = poses.robot(11.05) or pytest.fail("no pose")
    assert pose == pytest.approx(Pose(1.0, 0.0, 0.0).compose(odometry(11.0)))
    laser = poses.laser("laser", rospy.Time.from_sec(10.8), stamp)
    assert laser is not None
    assert odometry(11.0).compose(laser) == pytest.approx(odometry(10.8).compose(MOUNT), abs=1e-6)
    assert abs(laser.yaw - MOUNT.yaw) == pytest.approx(0.3, abs=1e-6)


def test_a_scan_from_before_or_after_all_odometry_is_taken_as_mounted(poses: TfPoses) -> None:
    for taken in (9.0, 11.04):
        assert poses.laser("laser", rospy.Time.from_sec(taken), rospy.Time.from_sec(11.0)) == pytest.approx(MOUNT)


def test_an_old_pose_and_an_unknown_laser_are_none(poses: TfPoses) -> None:
    assert poses.robot(11.6) is None
    assert poses.laser("camera", rospy.Time.from_sec(10.8), rospy.Time.from_sec(11.0)) is None
