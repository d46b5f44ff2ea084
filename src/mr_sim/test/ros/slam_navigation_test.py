#!/usr/bin/env python3
"""The nodes slam and move_base: topics, tf, and the ways an action can end."""

import math
import queue
import sys
import unittest

import actionlib
import rospy
import rostest
import tf2_ros
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import MapMetaData, OccupancyGrid

PATIENCE = rospy.Duration(60.0)  # simulated


def goal(x, y, frame="map", w=1.0):
    message = MoveBaseGoal()
    message.target_pose.header.frame_id = frame
    message.target_pose.pose.position.x, message.target_pose.pose.position.y = x, y
    message.target_pose.pose.orientation.w = w
    return message


class SlamNavigationTest(unittest.TestCase):
    def setUp(self):
        self.client = actionlib.SimpleActionClient("move_base", MoveBaseAction)
        self.assertTrue(self.client.wait_for_server(PATIENCE))
        self.buffer = tf2_ros.Buffer()
        listener = tf2_ros.TransformListener(self.buffer)
        self.addCleanup(listener.unregister)
        self.first = rospy.wait_for_message("map", OccupancyGrid, 60.0)

    def pose(self, stamp=None):
        transform = self.buffer.lookup_transform("map", "base_footprint", stamp or rospy.Time(0), PATIENCE).transform
        return transform.translation.x, transform.translation.y

    def end(self, message):
        self.client.send_goal(message)
        self.assertTrue(self.client.wait_for_result(PATIENCE))
        return self.client.get_state(), self.client.get_goal_status_text()

    def test_map(self):
        info = self.first.info
        self.assertEqual(self.first.header.frame_id, "map")
        self.assertAlmostEqual(info.resolution, 0.05, places=6)
        for corner in (info.origin.position.x, info.origin.position.y):
            self.assertAlmostEqual(corner / 0.05, round(corner / 0.05), places=4)
        self.assertLessEqual(set(self.first.data), {-1, 0, 100})
        self.assertEqual(len(self.first.data), info.width * info.height)
        self.assertEqual(rospy.wait_for_message("map_metadata", MapMetaData, 60.0).resolution, info.resolution)

    def test_goals_end_as_they_should(self):
        feedback = queue.Queue()
        start = self.pose()
        x, y = start[0] + 1.0, start[1]
        self.client.send_goal(goal(x, y), feedback_cb=feedback.put)
        self.assertTrue(self.client.wait_for_result(PATIENCE))
        self.assertEqual(self.client.get_state(), GoalStatus.SUCCEEDED, self.client.get_goal_status_text())
        self.assertLess(math.dist(self.pose(), (x, y)), 0.3)
        self.assertGreater(feedback.qsize(), 2)
        for told in [feedback.get().base_position for _ in range(feedback.qsize())]:
            self.assertEqual(told.header.frame_id, "map")
            here = told.pose.position.x, told.pose.position.y
            self.assertLess(math.dist(here, self.pose(told.header.stamp)), 0.01, "the stamp is of another pose")

        state, text = self.end(goal(100.0, 0.0))
        self.assertEqual((state, text), (GoalStatus.ABORTED, "no way to (100.00, 0.00): the goal lies outside the map"))
        state, text = self.end(goal(0.0, 0.0, frame="nowhere"))
        self.assertEqual(state, GoalStatus.ABORTED)
        self.assertIn("frame nowhere", text)
        state, text = self.end(goal(0.0, 0.0, w=0.0))
        self.assertEqual(state, GoalStatus.ABORTED)
        self.assertIn("orientation", text)

        active = queue.Queue()
        self.client.send_goal(goal(*start), active_cb=lambda: active.put(True))
        active.get(timeout=PATIENCE.to_sec())  # goals and cancellations travel on different topics
        self.client.cancel_goal()
        self.assertTrue(self.client.wait_for_result(PATIENCE))
        self.assertEqual(self.client.get_state(), GoalStatus.PREEMPTED)


if __name__ == "__main__":
    rospy.init_node("slam_navigation_test")
    rostest.rosrun("mr_sim", "slam_navigation", SlamNavigationTest, sys.argv)
