#!/usr/bin/env python3
"""SLAM begins a new map behind a relay, which hides that the map has another publisher: tf tells."""

import os
import subprocess
import sys
import unittest

import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import OccupancyGrid, Odometry

from map_merger.kept_run import SKIPPED

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import fake_adhoc as fake

SLAM = """
import sys, rospy, tf2_ros
sys.path.insert(0, sys.argv[1])
import fake_adhoc as fake
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import OccupancyGrid
rospy.init_node("slam")
broadcaster = tf2_ros.TransformBroadcaster()
local = rospy.Publisher("slam_map", OccupancyGrid, queue_size=2, latch=True)
transform = TransformStamped(child_frame_id="odom")
transform.header.frame_id = "map"
transform.transform.rotation.w = 1.0
transform.transform.translation.x = float(sys.argv[2])
while not rospy.is_shutdown():
    transform.header.stamp = rospy.Time.now()
    broadcaster.sendTransform(transform)
    local.publish(fake.map_message(fake.small_map()))
    rospy.sleep(0.1)
"""


class RelayTest(unittest.TestCase):
    """One story, told by the runs that the anchors and the global map name."""

    @classmethod
    def setUpClass(cls):
        rospy.init_node("test_relay")
        cls.adhoc = fake.FakeAdhoc()
        cls.drive()
        cls.maps = []
        cls.listener = rospy.Subscriber("map_merger/global_map", OccupancyGrid, cls.maps.append)
        cls.slam = cls.start_slam()

    @classmethod
    def tearDownClass(cls):
        cls.slam.kill()
        cls.slam.wait()

    @classmethod
    def drive(cls):
        """Odometry, ten times a second."""
        broadcaster = tf2_ros.TransformBroadcaster()
        publisher = rospy.Publisher("odom", Odometry, queue_size=2)
        transform, odometry = TransformStamped(child_frame_id="base"), Odometry(child_frame_id="base")
        transform.header.frame_id = odometry.header.frame_id = "odom"
        transform.transform.rotation.w = odometry.pose.pose.orientation.w = 1.0

        def tell(_):
            transform.header.stamp = odometry.header.stamp = rospy.Time.now()
            broadcaster.sendTransform(transform)
            publisher.publish(odometry)

        cls.timer = rospy.Timer(rospy.Duration(0.1), tell)

    @staticmethod
    def start_slam(odometry=0.0):
        """`odometry`: m, where its frame lies in that of the map."""
        return subprocess.Popen([sys.executable, "-c", SLAM, os.path.dirname(os.path.abspath(__file__)), str(odometry)])

    def test_the_run_is_another_one(self):
        former = self.adhoc.wait_for_anchor(lambda anchor: anchor.updates > 0)
        self.wait(lambda: rospy.get_param("/map_merger_run", {}).get("teller"), "tf did not say who SLAM is")
        self.slam.kill()
        self.slam.wait()
        type(self).slam = self.start_slam(odometry=-1.0)
        other = self.adhoc.wait_for_anchor(lambda anchor: anchor.boot != former.boot)
        self.assertLess(other.updates, SKIPPED)
        self.wait(lambda: {former.boot, other.boot} <= self.runs(), "the global map did not name its run")

    def runs(self):
        return {(each.info.map_load_time.secs, each.info.map_load_time.nsecs) for each in self.maps}

    @staticmethod
    def wait(done, complaint):
        deadline = rospy.get_time() + fake.WAIT_S
        while not done():
            assert rospy.get_time() < deadline, complaint
            rospy.sleep(0.05)


if __name__ == "__main__":
    rostest.rosrun("map_merger", "relay", RelayTest)
