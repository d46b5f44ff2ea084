#!/usr/bin/env python3
"""The node with a laser and a robot in hearing that is not placed: tracks that it tells, its status, its services."""

import os
import sys
import tempfile
import unittest

import numpy as np
import rospy
import rostest
import tf2_ros
from map_merger.msg import MergerStatus, RobotTrack
from map_merger.srv import ForgetRobot, SaveMap
from nav_msgs.msg import OccupancyGrid, Odometry
from sensor_msgs.msg import LaserScan

from map_merger import ros_io
from map_merger.messages import Anchor, Tile
from map_merger.ros_team import track_report_of
from mr_grid import Pose
from mr_grid.map_files import read_map
from mr_grid.ros import pose_message

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import fake_adhoc as fake

MAP_TO_ODOM = Pose(1.0, 0.5, 0.5 * np.pi)
ODOM_TO_BASE = Pose(0.5, 0.0, 0.0)
BASE_TO_LASER = Pose(0.1, 0.0, 0.0)
BODY_M, AHEAD_M, FARTHEST_M = 0.2, 2.0, 6.0
BEAMS, STEP = 361, np.pi / 360.0
BOOT = (7, 0)


def somebody_ahead():
    """Ranges of a laser in a wide hall in which something of a robot's size stands AHEAD_M before it."""
    angles = np.arange(BEAMS) * STEP - 0.5 * np.pi
    aside = AHEAD_M * np.sin(angles)
    hit = (np.abs(aside) < BODY_M) & (np.cos(angles) > 0.5)
    depth = np.sqrt(np.maximum(BODY_M**2 - aside**2, 0.0))
    return np.where(hit, AHEAD_M * np.cos(angles) - depth, FARTHEST_M).tolist()


class TeamTest(unittest.TestCase):
    """One story: robot_1 is heard, looked for, told of, and forgotten."""

    @classmethod
    def setUpClass(cls):
        rospy.init_node("test_team")
        cls.adhoc = fake.FakeAdhoc()
        cls.local = rospy.Publisher("map", OccupancyGrid, queue_size=2, latch=True)
        cls.odometry = rospy.Publisher("odom", Odometry, queue_size=2)
        cls.scans = rospy.Publisher("base_scan", LaserScan, queue_size=2)
        cls.status = fake.Latest("map_merger/status", MergerStatus)
        cls.tree = tf2_ros.TransformBroadcaster()
        cls.drive = rospy.Timer(rospy.Duration(0.1), cls.publish_robot)
        cls.map = fake.small_map()
        cls.local.publish(fake.map_message(cls.map))
        fake.connected(cls.adhoc.meta_other).publish(fake.plain_anchor(Anchor("robot_1", cls.map.info, BOOT, 1)))
        tile = Tile("robot_1", (0,), 0, 0, cls.map.cells, cls.map.info.resolution, BOOT, 1)
        fake.connected(cls.adhoc.map_other).publish(fake.plain_tile(tile))

    @classmethod
    def publish_robot(cls, _):
        """What the drivers and SLAM of a robot publish."""
        stamp = rospy.Time.now()
        chain = (("map", "odom", MAP_TO_ODOM), ("odom", "base", ODOM_TO_BASE), ("base", "laser", BASE_TO_LASER))
        for parent, child, transform in chain:
            cls.tree.sendTransform(ros_io.transform_messages([(child, transform)], parent, stamp))
        odometry = Odometry(child_frame_id="base")
        odometry.header.frame_id, odometry.header.stamp = "odom", stamp
        odometry.pose.pose = pose_message(ODOM_TO_BASE)
        cls.odometry.publish(odometry)
        scan = LaserScan(angle_min=-0.5 * np.pi, angle_max=0.5 * np.pi, angle_increment=STEP, range_max=FARTHEST_M)
        scan.header.frame_id, scan.header.stamp = "laser", stamp
        scan.ranges = somebody_ahead()
        cls.scans.publish(scan)

    def test_1_scans_become_tracks_that_are_told(self):
        def tells_objects(service, to, topic, message):
            return (service, to, topic) == ("message", "mc_robot_0", "map_merger/robot_track") and message.objects

        message = self.adhoc.wait_for(tells_objects)[3]
        self.assertIsInstance(message, RobotTrack)
        report = track_report_of(message)
        self.assertEqual((report.robot, report.unplaced), ("robot_0", ("robot_1",)))
        self.assertAlmostEqual(report.sensor.view, np.pi, places=2)
        base = MAP_TO_ODOM.compose(ODOM_TO_BASE)
        np.testing.assert_allclose(report.poses[-1, 1:], base, atol=0.01)
        place = base.compose(BASE_TO_LASER).apply_point(AHEAD_M, 0.0)
        np.testing.assert_allclose(report.objects[0].samples[-1, 1:], place, atol=0.1)

    def test_2_the_status_says_why_a_robot_is_not_placed(self):
        status = self.status.wait_for(lambda message: any(robot.why for robot in message.robots))
        (robot,) = status.robots
        self.assertEqual((status.robot, status.header.frame_id, robot.robot), ("robot_0", "map", "robot_1"))
        self.assertFalse(robot.placed)
        self.assertIn("robot_1 does not tell its track", robot.why)
        self.assertEqual(robot.bytes_received, self.map.cells.size)

    def test_3_the_map_is_saved(self):
        rospy.wait_for_service("map_merger/saveMap", fake.WAIT_S)
        with tempfile.TemporaryDirectory() as folder:
            answer = rospy.ServiceProxy("map_merger/saveMap", SaveMap)(os.path.join(folder, "floor"))
            saved = read_map(answer.description)
        self.assertTrue(np.array_equal(saved.cells, self.map.cells))

    def test_4_a_robot_is_forgotten_once(self):
        forget = rospy.ServiceProxy("map_merger/forgetRobot", ForgetRobot)
        forget("robot_1")
        asked = rospy.Time.now()
        status = self.status.wait_for(lambda message: message.header.stamp > asked)
        self.assertEqual(status.robots, [])
        with self.assertRaisesRegex(rospy.ServiceException, "nothing is known of a robot 'robot_1'"):
            forget("robot_1")


if __name__ == "__main__":
    rostest.rosrun("map_merger", "team", TeamTest)
