#!/usr/bin/env python3
"""The robot node offers what stageros offers."""

import itertools
import math
import queue
import sys
import unittest

import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from programs import refused
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64

PATIENCE = 30.0  # wall seconds


class Listener:
    """Messages of a topic from now on."""

    def __init__(self, topic, message_type):
        self._queue = queue.Queue()
        self._subscriber = rospy.Subscriber(topic, message_type, self._queue.put)

    def next(self):
        return self._queue.get(timeout=PATIENCE)

    def until(self, condition):
        while True:
            message = self.next()
            if condition(message):
                return message

    def close(self):
        self._subscriber.unregister()


def twist(linear=0.0, angular=0.0):
    message = Twist()
    message.linear.x, message.angular.z = linear, angular
    return message


class RobotNodeTest(unittest.TestCase):
    def listen(self, topic, message_type):
        listener = Listener(topic, message_type)
        self.addCleanup(listener.close)
        return listener

    def commander(self):
        publisher = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.addCleanup(publisher.unregister)
        odometry = self.listen("odom", Odometry)
        odometry.until(lambda _: publisher.get_num_connections() > 0)
        return publisher, odometry

    def test_topics_and_types(self):
        types = dict(rospy.get_published_topics())
        self.listen("base_scan", LaserScan).next()
        self.assertEqual(types["/odom"], "nav_msgs/Odometry")
        self.assertEqual(types["/base_pose_ground_truth"], "nav_msgs/Odometry")
        self.assertEqual(types["/base_scan"], "sensor_msgs/LaserScan")
        self.assertEqual(types["/clock"], "rosgraph_msgs/Clock")
        self.assertTrue(rospy.get_param("/use_sim_time"))

    def test_scan(self):
        scans = self.listen("base_scan", LaserScan)
        first, second = scans.next(), scans.next()
        self.assertEqual(first.header.frame_id, "base_laser_link")
        self.assertAlmostEqual((second.header.stamp - first.header.stamp).to_sec(), 0.1)
        self.assertEqual(len(first.ranges), 541)
        self.assertAlmostEqual(first.angle_min, -math.radians(135), places=5)
        self.assertAlmostEqual(first.angle_max, math.radians(135), places=5)
        self.assertAlmostEqual(first.angle_increment, math.radians(0.5), places=6)
        self.assertEqual((first.range_min, first.range_max), (0.0, 8.0))
        self.assertNotEqual(first.ranges, second.ranges, "no beam twice: each sweep has noise of its own")
        self.assertTrue(0.4 < min(first.ranges) < 1.2, "the start is 0.8 m from the middle of a wall")

    def test_odometry_truth_and_clock_come_at_each_base_update(self):
        odometry, clock = self.listen("odom", Odometry), self.listen("/clock", Clock)
        truth = self.listen("base_pose_ground_truth", Odometry)
        stamps = [odometry.next().header.stamp for _ in range(4)]
        self.assertEqual([round((b - a).to_sec(), 6) for a, b in itertools.pairwise(stamps)], [0.05] * 3)
        ticks = [clock.next().clock for _ in range(3)]
        self.assertEqual([round((b - a).to_sec(), 6) for a, b in itertools.pairwise(ticks)], [0.05] * 2)
        message = odometry.next()
        self.assertEqual((message.header.frame_id, message.child_frame_id), ("odom", "base_footprint"))
        self.assertGreater(truth.next().pose.pose.position.x, 0.5)

    def test_its_clock_can_be_set_wrong(self):
        offsets = rospy.Publisher("robot/clock_offset", Float64, queue_size=1, latch=True)
        self.addCleanup(offsets.unregister)
        clock = self.listen("/clock", Clock)
        now = clock.next().clock
        offsets.publish(1000.0)
        clock.until(lambda message: message.clock > now + rospy.Duration(1000.0))
        offsets.publish(0.0)
        clock.until(lambda message: message.clock < now + rospy.Duration(500.0))

    def test_transforms_reach_the_laser(self):
        buffer = tf2_ros.Buffer()
        listener = tf2_ros.TransformListener(buffer)
        buffer.lookup_transform("odom", "base_laser_link", rospy.Time(0), rospy.Duration(10.0))  # it hears by now
        stamp = self.listen("odom", Odometry).next().header.stamp
        whole = buffer.lookup_transform("odom", "base_laser_link", stamp, rospy.Duration(10.0))
        laser = buffer.lookup_transform("base_footprint", "base_laser_link", stamp, rospy.Duration(10.0))
        self.assertEqual(laser.transform.translation.x, 0.1)
        self.assertEqual(whole.header.stamp, stamp)
        listener.unregister()

    def test_robot_drives_and_stops_without_commands(self):
        publisher, odometry = self.commander()
        truth = self.listen("base_pose_ground_truth", Odometry)
        publisher.publish(twist(angular=1.0))
        moving = odometry.until(lambda m: m.twist.twist.angular.z == 1.0).header.stamp
        turning = truth.until(lambda m: m.header.stamp >= moving)
        self.assertAlmostEqual(turning.twist.twist.angular.z, 1.0)
        stopped = odometry.until(lambda m: m.header.stamp > moving and m.twist.twist.angular.z == 0.0).header.stamp
        self.assertAlmostEqual((stopped - moving).to_sec(), 0.5, places=6)

    def test_ground_truth_twist_is_in_the_world_frame(self):
        publisher, odometry = self.commander()
        truth = self.listen("base_pose_ground_truth", Odometry)

        def turned(message):
            publisher.publish(twist(angular=1.0))
            return message.pose.pose.orientation.z > 0.6

        pose = odometry.until(turned).pose.pose
        publisher.publish(twist(linear=0.2))
        velocity = truth.until(lambda m: abs(math.hypot(m.twist.twist.linear.x, m.twist.twist.linear.y) - 0.2) < 1e-9)
        self.assertGreater(velocity.twist.twist.linear.y, 0.1)
        self.assertGreater(pose.orientation.z, 0.6)

    def test_commands_that_are_no_numbers_are_ignored(self):
        publisher, odometry = self.commander()
        publisher.publish(twist(linear=math.nan))
        publisher.publish(twist(angular=0.7))
        message = odometry.until(lambda m: m.twist.twist.angular.z == 0.7)
        self.assertTrue(math.isfinite(message.pose.pose.position.x))


class BadParameterTest(unittest.TestCase):
    def test_missing_socket(self):
        self.assertIn("~socket is not set", refused(self, "robot"))

    def test_wrong_type(self):
        error = refused(self, "robot", "_socket:=/tmp/x", "_connect_timeout:=soon")
        self.assertIn("~connect_timeout must be of type float", error)

    def test_nobody_listens(self):
        error = refused(self, "robot", "_socket:=/nonexistent/world", "_connect_timeout:=0.0")
        self.assertIn("no world listens on /nonexistent/world", error)

    def test_unknown_and_used_robot_name(self):
        socket = rospy.get_param("/robot/socket")
        self.assertIn("is connected already", refused(self, "robot", f"_socket:={socket}", "_robot_name:=robot_0"))
        self.assertIn('no robot "nobody"', refused(self, "robot", f"_socket:={socket}", "_robot_name:=nobody"))


class Suite(unittest.TestSuite):
    def __init__(self):
        super().__init__()
        for case in (RobotNodeTest, BadParameterTest):
            self.addTests(unittest.defaultTestLoader.loadTestsFromTestCase(case))


if __name__ == "__main__":
    rospy.init_node("robot_node_test", disable_rostime=True)
    rostest.rosrun("mr_sim", "robot_node", "robot_node_test.Suite", sys.argv)
