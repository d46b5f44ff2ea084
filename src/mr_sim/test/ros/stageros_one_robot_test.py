#!/usr/bin/env python3
"""stageros with one robot: names, service, parameters, intensities."""

import queue
import sys
import time
import unittest

import rospy
import rostest
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from programs import refused
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty

PATIENCE = 30.0  # wall seconds
START = -3.0  # m, x


class OneRobotTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        """One publisher for all: a subscriber that is still bound to one that ended does not look for the next."""
        cls._publisher = rospy.Publisher("cmd_vel", Twist, queue_size=1)

    def setUp(self):
        self._subscribers = []

    def tearDown(self):
        for subscriber in self._subscribers:
            subscriber.unregister()

    def listen(self, topic, message_type, callback):
        self._subscribers.append(rospy.Subscriber(topic, message_type, callback))

    def drive(self, _):
        command = Twist()
        command.linear.x = 0.5
        self._publisher.publish(command)

    def test_names_have_no_prefix(self):
        odometry = rospy.wait_for_message("/odom", Odometry, PATIENCE)
        self.assertEqual((odometry.header.frame_id, odometry.child_frame_id), ("odom", "base_footprint"))
        self.assertEqual(rospy.wait_for_message("/base_scan", LaserScan, PATIENCE).header.frame_id, "base_laser_link")
        self.assertEqual(rospy.wait_for_message("/base_pose_ground_truth", Odometry, PATIENCE).header.frame_id, "odom")

    def test_intensities_are_the_ranger_returns(self):
        scan = rospy.wait_for_message("base_scan", LaserScan, PATIENCE)
        self.assertEqual((len(scan.ranges), len(scan.intensities)), (181, 181))
        self.assertEqual(scan.intensities[90 - 8], 300.5)
        self.assertEqual((scan.intensities[0], scan.intensities[180]), (1.0, 1.0))

    def test_robot_goes_back_to_its_start_while_it_drives(self):
        truths, odometries = queue.Queue(), {}
        self.listen("odom", Odometry, self.drive)
        self.listen("odom", Odometry, lambda m: odometries.update({m.header.stamp: m.pose.pose.position.x}))
        self.listen("base_pose_ground_truth", Odometry, truths.put)
        while truths.get(timeout=PATIENCE).pose.pose.position.x < START + 0.5:
            pass
        rospy.wait_for_service("reset_positions", PATIENCE)
        rospy.ServiceProxy("reset_positions", Empty)()
        truth = truths.get(timeout=PATIENCE)
        while truth.pose.pose.position.x > START + 0.3:
            truth = truths.get(timeout=PATIENCE)
        self.assertAlmostEqual(truth.pose.pose.position.y, 1.0)
        while truth.header.stamp not in odometries:
            truth = truths.get(timeout=PATIENCE)
        self.assertGreater(odometries[truth.header.stamp], 0.5, "its odometry goes on")
        while truths.get(timeout=PATIENCE).pose.pose.position.x < START + 0.4:
            pass  # and it drives on

    def test_robot_stops_after_the_time_of_the_parameter(self):
        odometries = queue.Queue()
        self.listen("odom", Odometry, odometries.put)

        def first(speed):
            message = odometries.get(timeout=PATIENCE)
            while message.twist.twist.linear.x != speed:
                message = odometries.get(timeout=PATIENCE)
            return message.header.stamp

        first(0.0)
        connected_until = time.monotonic() + PATIENCE
        while not self._publisher.get_num_connections():
            self.assertLess(time.monotonic(), connected_until, "stageros does not listen to cmd_vel")
            odometries.get(timeout=PATIENCE)
        self.drive(None)
        moving = first(0.5)
        self.assertAlmostEqual((first(0.0) - moving).to_sec(), 0.2)


class ProgramTest(unittest.TestCase):
    def test_bad_parameter(self):
        error = refused(self, "stageros", "-g", "_base_watchdog_timeout:=soon", "small8x8")
        self.assertIn("stageros: ~base_watchdog_timeout must be a number of seconds", error)
        rospy.delete_param("/refused")

    def test_what_does_nothing_is_named_once(self):
        error = refused(self, "stageros", "-g", "--clock", "_is_depth_canonical:=true", "_robots:=9", "small8x8")
        warning = "without effect here: parameters ~is_depth_canonical; arguments --clock"
        self.assertEqual(error.count(warning), 1)
        self.assertIn("asked for 9", error)
        rospy.delete_param("/refused")


class Suite(unittest.TestSuite):
    def __init__(self):
        super().__init__()
        for case in (OneRobotTest, ProgramTest):
            self.addTests(unittest.defaultTestLoader.loadTestsFromTestCase(case))


if __name__ == "__main__":
    rospy.init_node("stageros_one_robot_test", disable_rostime=True)
    rostest.rosrun("mr_sim", "stageros_one_robot", "stageros_one_robot_test.Suite", sys.argv)
