#!/usr/bin/env python3
"""The node on its own master with a stand-in for the radio: topics, services, files, tf."""

import os
import sys
import unittest

import numpy as np
import rospy
import rostest
import tf2_ros
from adhoc_communication.msg import MmControl, MmListOfPoints, MmPoint, Status
from geometry_msgs.msg import TransformStamped
from map_merger.srv import LogMaps, TransformPoint
from nav_msgs.msg import OccupancyGrid, Odometry
from visualization_msgs.msg import MarkerArray

from map_merger import ros_io
from map_merger.messages import Anchor, Position, Tile
from mr_grid import Pose

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import fake_adhoc as fake

BOOT = (7, 0)


class NodeTest(unittest.TestCase):
    """One story: alone, then a peer arrives, is merged, and is asked for what is missing."""

    @classmethod
    def setUpClass(cls):
        rospy.init_node("test_node")
        cls.adhoc = fake.FakeAdhoc(neighbors=["robot_9"])
        cls.local = rospy.Publisher("map", OccupancyGrid, queue_size=2, latch=True)
        cls.odometry = rospy.Publisher("odom", Odometry, queue_size=2, latch=True)
        cls.merged = fake.Latest("map_merger/global_map", OccupancyGrid)
        cls.target, cls.source, cls.truth = fake.building()
        tree = tf2_ros.StaticTransformBroadcaster()
        odom = TransformStamped()
        odom.header.frame_id, odom.child_frame_id = "map", "odom"
        odom.transform.translation.x, odom.transform.rotation.w = 2.0, 1.0
        tree.sendTransform(odom)
        cls.tree = tree
        cls.listener_buffer = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.listener_buffer)

    def test_1_alone_the_global_map_is_the_local_one_and_changes_are_sent(self):
        message = fake.map_message(self.target)
        self.local.publish(message)
        merged = self.merged.wait_for(lambda m: m.info.width == message.info.width)
        self.assertEqual(merged.data, tuple(message.data))
        self.assertEqual(merged.header.frame_id, "map")
        self.assertEqual(merged.info.origin, message.info.origin)
        _, destination, topic, update = self.adhoc.wait_for(lambda service, *_: service == "map_update")
        self.assertEqual((destination, topic), ("mc_robot_0", "map_other"))
        self.assertEqual(update.map.header.frame_id, "robot_0")
        self.assertEqual(list(update.update_numbers), [0])
        first = next(record for record in self.adhoc.sent if record[0] in ("map", "map_update"))
        self.assertEqual((first[0], first[1], first[2]), ("map", "mc_robot_0", "map_meta_other"))
        self.assertEqual((first[3].info.width, first[3].info.height, len(first[3].data)), (0, 0, 0))
        self.assertAlmostEqual(first[3].info.origin.position.x, message.info.origin.position.x, places=6)

    def test_2_neighbours_and_announced_robots_are_asked_for_everything(self):
        self.adhoc.wait_for(
            lambda service, to, topic, what: (
                (service, to, topic) == ("control", "robot_9", "control")
                and what.src_robot == "robot_0"
                and not what.update_numbers
            )
        )
        fake.connected(self.adhoc.status).publish(Status(robots=["robot_0", "robot_8"]))
        self.adhoc.wait_for(lambda service, to, *_: (service, to) == ("control", "robot_8"))

    def test_3_transform_point_fails_with_a_text_while_there_is_no_transform(self):
        rospy.wait_for_service("map_merger/transformPoint", fake.WAIT_S)
        with self.assertRaisesRegex(rospy.ServiceException, "no transform to robot_7"):
            rospy.ServiceProxy("map_merger/transformPoint", TransformPoint)(MmPoint("robot_7", 0.0, 0.0))

    def test_4_a_full_map_is_given_on_request(self):
        self.adhoc.forget()
        fake.connected(self.adhoc.control).publish(MmControl("robot_1", []))
        self.adhoc.wait_for(lambda service, to, *_: (service, to) == ("map", "robot_1"))
        update = self.adhoc.wait_for(lambda service, to, *_: (service, to) == ("map_update", "robot_1"))[3]
        self.assertEqual(update.update_numbers[0], 0)
        known = np.count_nonzero(np.array(update.map.data) != -1)
        self.assertEqual(known, np.count_nonzero(self.target.cells != -1))

    def test_5_a_peer_is_merged_though_it_was_never_announced(self):
        fake.connected(self.adhoc.meta_other).publish(fake.plain_anchor(Anchor("robot_1", self.source.info, BOOT, 1)))
        tile = Tile("robot_1", (0,), 0, 0, self.source.cells, self.source.info.resolution, BOOT, 1)
        fake.connected(self.adhoc.map_other).publish(fake.plain_tile(tile))
        alone = np.count_nonzero(self.target.cells != -1)
        merged = self.merged.wait_for(lambda m: np.count_nonzero(np.array(m.data) != -1) > alone)
        self.assertAlmostEqual(merged.info.resolution, self.target.info.resolution, places=6)
        frame = self.listener_buffer.lookup_transform("map", "robot_1/map", rospy.Time(0), rospy.Duration(fake.WAIT_S))
        found = ros_io.transform_of_message(frame)
        self.assertLess(np.hypot(found.x - self.truth.x, found.y - self.truth.y), 0.1)
        answer = rospy.ServiceProxy("map_merger/transformPoint", TransformPoint)(MmPoint("robot_1", 1.0, 2.0)).point
        expected = self.truth.apply_point(1.0, 2.0)
        self.assertEqual(answer.src_robot, "robot_0")
        self.assertLess(np.hypot(answer.x - expected[0], answer.y - expected[1]), 0.15)

    def test_6_positions_are_sent_in_the_map_frame_and_listed_in_the_own_one(self):
        odometry = Odometry()
        odometry.header.frame_id, odometry.child_frame_id = "odom", "base_footprint"
        odometry.pose.pose.position.x, odometry.pose.pose.orientation.w = 1.0, 1.0
        fake.connected(self.odometry).publish(odometry)
        position = self.adhoc.wait_for(lambda service, *_: service == "position")[3]
        self.assertEqual((position.src_robot, position.position.header.frame_id), ("robot_0", "map"))
        self.assertAlmostEqual(position.position.pose.position.x, 3.0, places=6)
        positions = fake.Latest("all_positions", MmListOfPoints)
        tracks = fake.Latest("map_merger/position_robot_1", MarkerArray)
        fake.connected(self.adhoc.positions).publish(
            ros_io.position_message(Position("robot_1", Pose(1.0, 2.0, 0.0)), "map", rospy.Time(1))
        )
        point = positions.wait_for(lambda m: m.positions).positions[0]
        expected = self.truth.apply_point(1.0, 2.0)
        self.assertEqual(point.src_robot, "robot_1")
        self.assertLess(np.hypot(point.x - expected[0], point.y - expected[1]), 0.15)
        tracks.wait_for(lambda m: m.markers and m.markers[0].points and m.markers[0].header.frame_id == "map")

    def test_7_missing_updates_are_asked_for(self):
        self.adhoc.forget()
        tile = Tile("robot_1", (3,), 0, 0, np.zeros((2, 2), np.int8), self.source.info.resolution, BOOT, 4)
        self.adhoc.map_other.publish(fake.plain_tile(tile))
        request = self.adhoc.wait_for(lambda service, to, *_: (service, to) == ("control", "robot_1"))[3]
        self.assertEqual(list(request.update_numbers), [1, 2])

    def test_8_logs_and_debug_images(self):
        folder = os.path.join(rospy.get_param("map_merger/log_path"), "map_merger", "robot_0")
        self.assertTrue(os.path.exists(os.path.join(folder, "old.pgm")))
        rospy.ServiceProxy("map_merger/logOutput", LogMaps)(0x0F)
        with open(os.path.join(folder, "global.pgm"), "rb") as file:
            self.assertEqual(file.read(2), b"P5")
        with open(os.path.join(folder, "periodical.log"), encoding="utf-8") as file:
            fields = file.read().splitlines()[1].split()
        self.assertEqual(len(fields), 7)
        self.assertGreater(int(fields[1]), int(fields[2]))
        self.assertTrue(os.path.exists(os.path.join(folder, "updates_log")))

    def test_9_garbage_does_not_end_the_node(self):
        bad = OccupancyGrid()
        bad.header.frame_id, bad.info.width, bad.info.height, bad.info.resolution = "map", 9, 9, 0.05
        self.local.publish(bad)
        self.adhoc.control.publish(MmControl("robot_1", [10**6, -5]))
        self.adhoc.control.publish(MmControl("robot_1", [-1]))
        tile = fake.plain_tile(Tile("robot_1", (9,), 0, 0, np.zeros((2, 2), np.int8), 0.05, BOOT, 4))
        tile.map.info.width = 4000
        self.adhoc.map_other.publish(tile)
        tile.map.info.origin.position.x = float("nan")
        self.adhoc.map_other.publish(tile)
        bad.header.frame_id, bad.info.width, bad.info.height, bad.info.resolution = "robot_1", 0, 0, -1.0
        self.adhoc.meta_other.publish(bad)
        self.adhoc.forget()
        self.adhoc.control.publish(MmControl("robot_1", []))
        self.adhoc.wait_for(lambda service, to, *_: (service, to) == ("map_update", "robot_1"))


if __name__ == "__main__":
    rostest.rosrun("map_merger", "node", NodeTest)
