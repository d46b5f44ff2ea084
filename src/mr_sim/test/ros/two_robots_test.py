#!/usr/bin/env python3
"""Two robots under one master keep apart."""

import math
import sys
import unittest

import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

PATIENCE = 30.0


class TwoRobotsTest(unittest.TestCase):
    def test_names_frames_and_commands(self):
        for index, y in ((0, 0.8), (1, 1.7)):
            name = f"robot_{index}/"
            odometry = rospy.wait_for_message(name + "odom", Odometry, PATIENCE)
            self.assertEqual(odometry.header.frame_id, name + "odom")
            self.assertEqual(odometry.child_frame_id, name + "base_footprint")
            scan = rospy.wait_for_message(name + "base_scan", LaserScan, PATIENCE)
            self.assertEqual(scan.header.frame_id, name + "base_laser_link")
            truth = rospy.wait_for_message(name + "base_pose_ground_truth", Odometry, PATIENCE)
            self.assertAlmostEqual(truth.pose.pose.position.y, y)

    def test_transforms_carry_the_prefix(self):
        buffer = tf2_ros.Buffer()
        listener = tf2_ros.TransformListener(buffer)
        for name in ("robot_0/", "robot_1/"):
            frames = name + "odom", name + "base_laser_link"
            laser = buffer.lookup_transform(*frames, rospy.Time(0), rospy.Duration(PATIENCE))
            self.assertAlmostEqual(math.hypot(laser.transform.translation.x, laser.transform.translation.y), 0.1)
        self.assertFalse(buffer.can_transform("robot_0/odom", "robot_1/odom", rospy.Time(0)))
        listener.unregister()

    def test_a_command_moves_one_of_them(self):
        publisher = rospy.Publisher("robot_1/cmd_vel", Twist, queue_size=1, latch=True)
        command = Twist()
        command.angular.z = 0.5
        turned = False
        while not turned:
            publisher.publish(command)
            turned = rospy.wait_for_message("robot_1/odom", Odometry, PATIENCE).twist.twist.angular.z == 0.5
        other = rospy.wait_for_message("robot_0/base_pose_ground_truth", Odometry, PATIENCE)
        self.assertEqual(other.pose.pose.orientation.z, 0.0)


if __name__ == "__main__":
    rospy.init_node("two_robots_test", disable_rostime=True)
    rostest.rosrun("mr_sim", "two_robots", TwoRobotsTest, sys.argv)
