#!/usr/bin/env python3
"""A robot of a Stage world with several rangers that drives aside."""

import sys
import unittest

import rospy
import rostest
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

PATIENCE = 30.0


class RangersTest(unittest.TestCase):
    def test_first_sensors_have_the_numbers_of_stageros_and_the_others_follow(self):
        for index, (samples, range_max) in enumerate([(1, 5.0), (181, 8.0), (1, 4.0)]):
            scan = rospy.wait_for_message(f"base_scan_{index}", LaserScan, PATIENCE)
            self.assertEqual((len(scan.ranges), scan.range_max), (samples, range_max))
            self.assertEqual(scan.header.frame_id, f"base_laser_link_{index}")

    def test_robot_drives_aside(self):
        publisher = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        command = Twist()
        command.linear.y = 0.2
        odometry = rospy.wait_for_message("odom", Odometry, PATIENCE)
        while odometry.twist.twist.linear.y != 0.2 or odometry.pose.pose.position.y < 0.1:
            publisher.publish(command)
            odometry = rospy.wait_for_message("odom", Odometry, PATIENCE)
        self.assertAlmostEqual(odometry.pose.pose.position.x, 0.0)


if __name__ == "__main__":
    rospy.init_node("rangers_test", disable_rostime=True)
    rostest.rosrun("mr_sim", "rangers", RangersTest, sys.argv)
