#!/usr/bin/env python3
"""map_merger.launch with a prefix: names of services, topics and frames; and parameters that end the node."""

import os
import subprocess
import sys
import unittest

import numpy as np
import rospy
import rostest
import tf2_ros
from nav_msgs.msg import OccupancyGrid

from map_merger import ros_io
from map_merger.messages import Anchor, Tile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import fake_adhoc as fake


class PrefixTest(unittest.TestCase):
    """Everything of the robot is below its prefix."""

    @classmethod
    def setUpClass(cls):
        rospy.init_node("test_prefix")
        cls.adhoc = fake.FakeAdhoc("/robot_0/")
        cls.local = rospy.Publisher("/robot_0/map", OccupancyGrid, queue_size=2, latch=True)
        cls.merged = fake.Latest("/robot_0/map_merger/global_map", OccupancyGrid)

    def test_merging_below_the_prefix(self):
        target, source, truth = fake.building()
        self.local.publish(fake.map_message(target, "robot_0/map"))
        self.adhoc.wait_for(
            lambda service, to, topic, _: (service, to, topic) == ("map_update", "mc_robot_0", "map_other")
        )
        boot = (5, 5)
        fake.connected(self.adhoc.meta_other).publish(fake.plain_anchor(Anchor("robot_1", source.info, boot, 1)))
        tile = Tile("robot_1", (0,), 0, 0, source.cells, source.info.resolution, boot, 1)
        fake.connected(self.adhoc.map_other).publish(fake.plain_tile(tile))
        alone = np.count_nonzero(target.cells != -1)
        merged = self.merged.wait_for(lambda m: np.count_nonzero(np.array(m.data) != -1) > alone)
        self.assertEqual(merged.header.frame_id, "robot_0/map")
        frames = tf2_ros.Buffer()
        listener = tf2_ros.TransformListener(frames)
        found = frames.lookup_transform(
            "robot_0/map", "robot_0/robot_1/map", rospy.Time(0), rospy.Duration(fake.WAIT_S)
        )
        self.assertLess(abs(ros_io.transform_of_message(found).yaw - truth.yaw), 0.01)
        listener.unregister()

    def run_node(self, *arguments):
        return subprocess.run(
            ["rosrun", "map_merger", "map_merger", "__name:=bad", *arguments],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )

    def test_a_bad_parameter_ends_the_node_with_one_message(self):
        for argument, culprit in (
            ("_split_size:=0", "split_size"),
            ("_max_rotation_robots:=-7", "max_rotation_robots"),
            ("_registration:=magic", "registration"),
            ("_seconds_pub_timer:=soon", "seconds_pub_timer"),
        ):
            done = self.run_node(argument)
            output = done.stdout + done.stderr
            self.assertEqual(done.returncode, 1, output)
            self.assertNotIn("Traceback", output)
            self.assertEqual(output.count(f"parameter {culprit}"), 1, output)
            rospy.delete_param("/bad")


if __name__ == "__main__":
    rostest.rosrun("map_merger", "prefix", PrefixTest)
