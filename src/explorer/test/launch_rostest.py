#!/usr/bin/env python3
"""rostest: exploration.launch starts the node in simulation mode; parameters arrive; bad ones end it with one clear
message."""

import os
import subprocess
import sys
import threading
import unittest
from typing import List

import rosnode
import rospy
import rostest
from explorer.msg import ExplorationState


class TestLaunch(unittest.TestCase):
    def test_node_runs_under_the_robots_prefix(self) -> None:
        state = rospy.wait_for_message("/explorer/state", ExplorationState, timeout=20)
        self.assertEqual(state.robot_name, "robot_0")
        self.assertEqual(state.state, ExplorationState.STARTING)
        self.assertIn("/explorer", rosnode.get_node_names())
        topics = {name for name, _ in rospy.get_published_topics()}
        self.assertIn("/frontierPoints", topics)
        self.assertIn("/cluster_grid_19", topics)

    def test_the_arguments_arrive(self) -> None:
        rospy.wait_for_message("/explorer/state", ExplorationState, timeout=20)
        self.assertEqual(rospy.get_param("/explorer/strategy"), "nearest_path")
        self.assertEqual(rospy.get_param("/explorer/time_limit"), 300.0)
        self.assertEqual(rospy.get_param("/explorer/distance_limit"), 0.0)

    def test_robots_in_simulation_is_relative_and_logged(self) -> None:
        rospy.set_param("/robots_in_simulation", 1)
        rospy.set_param("/robot_0/robots_in_simulation", 7)
        node = subprocess.Popen(
            ["rosrun", "explorer", "explorer", "__ns:=/robot_0", "__name:=counted"],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
        watchdog = threading.Timer(30.0, node.kill)
        watchdog.start()
        lines: List[str] = []
        try:
            for line in node.stdout:
                lines.append(line.decode())
                if "robots in simulation" in lines[-1]:
                    break
            self.assertIn("robots in simulation: 7", "".join(lines))
        finally:
            watchdog.cancel()
            node.kill()
            node.wait()

    def test_out_of_range_is_one_message_and_exit_code(self) -> None:
        cases = (
            ("_frontier_selection:=9", "~frontier_selection is 9, out of range 0 to 7"),
            ("_view_distance:=far", "~view_distance is 'far', it must be of type float"),
            ("_robot_prefix:=/robot_1", "must carry the robot's number"),
        )
        for number, (setting, culprit) in enumerate(cases):
            done = subprocess.run(
                ["rosrun", "explorer", "explorer", f"__name:=broken_{number}", setting],
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                timeout=30,
            )
            text = done.stdout.decode()
            self.assertNotEqual(done.returncode, 0, text)
            self.assertIn(culprit, text)
            self.assertNotIn("Traceback", text)


if __name__ == "__main__":
    rospy.init_node("launch_rostest")
    rostest.rosrun("explorer", "exploration_launch", TestLaunch, sys.argv)
