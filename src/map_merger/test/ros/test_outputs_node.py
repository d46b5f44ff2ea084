#!/usr/bin/env python3
"""Publishers and services of the outputs, seen by plain subscribers and clients."""

import os
import sys
import tempfile
import unittest

import numpy as np
import rospy
import rostest
from map_merger.msg import MergerStatus
from map_merger.srv import ForgetRobot, SaveMap
from map_msgs.msg import OccupancyGridUpdate
from visualization_msgs.msg import MarkerArray

from map_merger import ros_outputs, status
from map_merger.grid import EMPTY_BOX, Box
from map_merger.markers import RobotMarker
from mr_grid import GridInfo, OccupancyGrid, Pose
from mr_grid.map_files import read_map

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import fake_adhoc as fake

CELLS = np.repeat(np.array([[-1], [0], [100]], np.int8), 40, axis=1)
MAP = OccupancyGrid(GridInfo(40, 3, 0.05), CELLS)
STAMP = rospy.Time(5)


class OutputsTest(unittest.TestCase):
    """The publishers live in this process, as in the node."""

    @classmethod
    def setUpClass(cls):
        rospy.init_node("outputs")
        cls.outputs = ros_outputs.Outputs("map")
        cls.map, cls.forgotten = MAP, []
        cls.services = ros_outputs.serve(lambda: cls.map, cls.forget)

    @classmethod
    def forget(cls, robot):
        if robot != "robot_1":
            raise KeyError(robot)
        cls.forgotten.append(robot)

    def test_the_status_is_latched(self):
        self.outputs.show_status(status.MergerStatus("robot_0", "distributed", "", ()), STAMP)
        received = fake.Latest("outputs/status", MergerStatus).wait_for(lambda message: True)
        self.assertEqual((received.robot, received.header.frame_id), ("robot_0", "map"))

    def test_markers_are_made_only_while_somebody_looks(self):
        self.outputs.show_team(lambda: self.fail("nobody looks"), STAMP)
        markers = fake.Latest("outputs/markers", MarkerArray)
        fake.connected(self.outputs._markers)
        robot = RobotMarker("robot_1", Pose(), np.zeros((0, 2)))
        self.outputs.show_team(lambda: [robot], STAMP)
        received = markers.wait_for(lambda message: True)
        self.assertEqual([marker.ns for marker in received.markers], ["robot_1", "robot_1"])

    def test_updates_hold_the_changed_part(self):
        updates = fake.Latest("outputs/global_map_updates", OccupancyGridUpdate)
        fake.connected(self.outputs._updates)
        self.outputs.show_update(MAP, EMPTY_BOX, STAMP)
        self.outputs.show_update(MAP, Box(1, 5, 3, 8), STAMP)
        received = updates.wait_for(lambda message: True)
        self.assertEqual((received.x, received.y, received.width, received.height), (5, 1, 3, 2))
        self.assertEqual(received.data, (0, 0, 0, 100, 100, 100))

    def test_the_map_is_saved_or_the_text_says_why_not(self):
        rospy.wait_for_service("outputs/saveMap", fake.WAIT_S)
        save = rospy.ServiceProxy("outputs/saveMap", SaveMap)
        with tempfile.TemporaryDirectory() as folder:
            answer = save(os.path.join(folder, "floor"))
            self.assertEqual(answer.picture, os.path.join(folder, "floor.pgm"))
            self.assertTrue(np.array_equal(read_map(answer.description).cells, CELLS))
            with self.assertRaisesRegex(rospy.ServiceException, "No such file"):
                save(os.path.join(folder, "missing", "floor"))
        type(self).map = None
        with self.assertRaisesRegex(rospy.ServiceException, "no map yet"):
            save("/tmp/floor")
        type(self).map = MAP

    def test_a_robot_is_forgotten_or_the_text_says_that_it_is_not_known(self):
        rospy.wait_for_service("outputs/forgetRobot", fake.WAIT_S)
        forget = rospy.ServiceProxy("outputs/forgetRobot", ForgetRobot)
        forget("robot_1")
        self.assertEqual(self.forgotten, ["robot_1"])
        with self.assertRaisesRegex(rospy.ServiceException, "nothing is known of a robot 'robot_7'"):
            forget("robot_7")


if __name__ == "__main__":
    rostest.rosrun("map_merger", "outputs", OutputsTest)
