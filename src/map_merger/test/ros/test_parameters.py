#!/usr/bin/env python3
"""Parameters that name topics over the network or say how maps are cut have their effect, out and in."""

import os
import sys
import unittest

import numpy as np
import rospy
import rostest
from adhoc_communication.msg import MmControl, MmListOfPoints
from nav_msgs.msg import OccupancyGrid as OccupancyGridMessage
from nav_msgs.msg import Odometry

from map_merger import ros_io
from map_merger.messages import Anchor, Position, Tile
from mr_grid import OccupancyGrid, Pose

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import fake_adhoc as fake

PIECES, CORNERS, QUESTIONS, PLACES = TOPICS = ("pieces", "corners", "questions", "places")
BOOT = (7, 0)


class ParametersTest(unittest.TestCase):
    """One story, with topics named as in parameters.test."""

    @classmethod
    def setUpClass(cls):
        rospy.init_node("test_parameters")
        cls.adhoc = fake.FakeAdhoc(topics=TOPICS)
        cls.local = rospy.Publisher("map", OccupancyGridMessage, queue_size=2, latch=True)
        cls.odometry = rospy.Publisher("odom", Odometry, queue_size=2, latch=True)
        cls.merged = fake.Latest("map_merger/global_map", OccupancyGridMessage)
        cls.listed = fake.Latest("all_positions", MmListOfPoints)
        cls.target, cls.source, cls.truth = fake.building()

    def known(self, message):
        return np.count_nonzero(np.array(message.data) != -1)

    def test_1_the_map_goes_to_its_topic_in_one_piece_and_the_anchor_to_its_own(self):
        self.local.publish(fake.map_message(self.target))
        update = self.adhoc.wait_for(lambda service, to, topic, _: (service, topic) == ("map_update", PIECES))[3]
        self.assertEqual(self.known(update.map), np.count_nonzero(self.target.cells != -1))
        self.adhoc.wait_for(lambda service, to, topic, _: (service, topic) == ("map", CORNERS))

    def test_2_the_position_goes_to_its_topic(self):
        odometry = Odometry()
        odometry.header.frame_id, odometry.pose.pose.orientation.w = "map", 1.0
        fake.connected(self.odometry).publish(odometry)
        self.adhoc.wait_for(lambda service, to, topic, _: (service, topic) == ("position", PLACES))

    def test_3_maps_and_positions_of_others_are_taken_from_these_topics(self):
        anchor = Anchor("robot_1", self.source.info, BOOT, 1)
        fake.connected(self.adhoc.meta_other).publish(fake.plain_anchor(anchor))
        tile = Tile("robot_1", (0,), 0, 0, self.source.cells, self.source.info.resolution, BOOT, 1)
        fake.connected(self.adhoc.map_other).publish(fake.plain_tile(tile))
        alone = np.count_nonzero(self.target.cells != -1)
        self.merged.wait_for(lambda message: self.known(message) > alone)
        position = Position("robot_1", Pose(1.0, 2.0, 0.0))
        fake.connected(self.adhoc.positions).publish(ros_io.position_message(position, "map", rospy.Time(1)))
        self.listed.wait_for(lambda message: [place.src_robot for place in message.positions] == ["robot_1"])

    def test_4_questions_go_to_their_topic_and_are_answered_from_it(self):
        tile = Tile("robot_1", (3,), 0, 0, np.zeros((2, 2), np.int8), self.source.info.resolution, BOOT, 4)
        self.adhoc.map_other.publish(fake.plain_tile(tile))
        self.adhoc.wait_for(lambda service, to, topic, _: (service, to, topic) == ("control", "robot_1", QUESTIONS))
        self.adhoc.forget()
        fake.connected(self.adhoc.control).publish(MmControl("robot_1", []))
        self.adhoc.wait_for(lambda service, to, topic, _: (service, to, topic) == ("map_update", "robot_1", PIECES))
        self.adhoc.wait_for(lambda service, to, topic, _: (service, to, topic) == ("map", "robot_1", CORNERS))

    def test_5_what_the_radio_refuses_for_its_size_comes_in_smaller_pieces(self):
        self.adhoc.largest_map = 10_000
        self.adhoc.forget()
        cells = np.where(self.target.cells == -1, np.int8(-1), np.int8(100) - self.target.cells).astype(np.int8)
        self.local.publish(fake.map_message(OccupancyGrid(self.target.info, cells)))
        update = self.adhoc.wait_for(lambda service, to, topic, _: (service, to) == ("map_update", "mc_robot_0"))[3]
        self.assertGreater(len(update.map.data), 1_000)


if __name__ == "__main__":
    rostest.rosrun("map_merger", "parameters", ParametersTest)
