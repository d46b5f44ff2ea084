#!/usr/bin/env python3
"""The node is started anew, then the node that makes the local map."""

import os
import signal
import subprocess
import sys
import unittest

import rosgraph
import rospy
import rostest

from map_merger.kept_run import SKIPPED

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import fake_adhoc as fake

SLAM = """
import sys, rospy
sys.path.insert(0, sys.argv[1])
import fake_adhoc as fake
from nav_msgs.msg import OccupancyGrid
rospy.init_node("slam")
local = rospy.Publisher("map", OccupancyGrid, queue_size=2, latch=True)
local.publish(fake.map_message(fake.small_map()))
rospy.spin()
"""


class RestartTest(unittest.TestCase):
    """One story, told by the runs that the anchors name."""

    @classmethod
    def setUpClass(cls):
        rospy.init_node("test_restart")
        cls.adhoc = fake.FakeAdhoc()
        cls.slam = cls.start_slam()

    @classmethod
    def tearDownClass(cls):
        cls.slam.kill()
        cls.slam.wait()

    @staticmethod
    def start_slam():
        return subprocess.Popen([sys.executable, "-c", SLAM, os.path.dirname(os.path.abspath(__file__))])

    def test_1_a_node_that_is_started_anew_goes_on_with_its_run(self):
        first = self.adhoc.wait_for_anchor(lambda anchor: anchor.updates > 0)
        self.assertEqual(first.boot, (7, 9))
        self.wait_until_kept(first.updates)
        master = rosgraph.Master("/test_restart")
        os.kill(self.pid_of(master), signal.SIGKILL)
        again = self.adhoc.wait_for_anchor(lambda anchor: anchor.updates > SKIPPED)
        self.assertEqual(again.boot, first.boot)
        self.assertEqual(again.info, first.info)

    def test_2_where_slam_is_started_anew_the_run_is_another_one(self):
        former = self.adhoc.wait_for_anchor(lambda anchor: anchor.updates > SKIPPED)
        self.slam.kill()
        self.slam.wait()
        type(self).slam = self.start_slam()
        other = self.adhoc.wait_for_anchor(lambda anchor: anchor.boot != former.boot)
        self.assertLess(other.updates, SKIPPED)

    @staticmethod
    def pid_of(master):
        proxy = rospy.core.xmlrpcapi(master.lookupNode("/map_merger"))
        return proxy.getPid("/test_restart")[2]

    @staticmethod
    def wait_until_kept(updates):
        deadline = rospy.get_time() + fake.WAIT_S
        while rospy.get_param("/map_merger_run", {}).get("updates", -1) < updates:
            assert rospy.get_time() < deadline, "the run was not kept"
            rospy.sleep(0.05)


if __name__ == "__main__":
    rostest.rosrun("map_merger", "restart", RestartTest)
