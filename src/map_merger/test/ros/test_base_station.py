#!/usr/bin/env python3
"""map_merger_base.launch: the first robot's map is the reference, the second is merged into it."""

import os
import sys
import unittest

import numpy as np
import rospy
import rostest
from adhoc_communication.msg import MmPoint
from map_merger.srv import TransformPoint
from nav_msgs.msg import OccupancyGrid
from std_msgs.msg import String

from map_merger.messages import Anchor, Tile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import fake_adhoc as fake


class BaseStationTest(unittest.TestCase):
    """Two robots, no own map."""

    def test_the_base_station_merges_the_maps_of_others(self):
        rospy.init_node("test_base_station")
        adhoc = fake.FakeAdhoc()
        merged = fake.Latest("map_merger/global_map", OccupancyGrid)
        target, source, truth = fake.building()
        fake.connected(adhoc.new_robot).publish(String("robot_0"))
        adhoc.wait_for(lambda service, to, *_: (service, to) == ("control", "robot_0"))
        known = 0
        for number, grid in enumerate((target, source)):
            robot, boot = f"robot_{number}", (3, number)
            fake.connected(adhoc.meta_other).publish(fake.plain_anchor(Anchor(robot, grid.info, boot, 1)))
            tile = Tile(robot, (0,), 0, 0, grid.cells, grid.info.resolution, boot, 1)
            fake.connected(adhoc.map_other).publish(fake.plain_tile(tile))
            before = known
            message = merged.wait_for(lambda m, before=before: np.count_nonzero(np.array(m.data) != -1) > before)
            known = np.count_nonzero(np.array(message.data) != -1)
            self.assertEqual(message.header.frame_id, "map")
        ask = rospy.ServiceProxy("map_merger/transformPoint", TransformPoint)
        point = ask(MmPoint("robot_1", 1.0, 2.0)).point
        expected = truth.apply_point(1.0, 2.0)
        self.assertLess(np.hypot(point.x - expected[0], point.y - expected[1]), 0.15)
        point = ask(MmPoint("robot_0", 1.0, 2.0)).point
        self.assertEqual((point.x, point.y), (1.0, 2.0))
        self.assertFalse([record for record in adhoc.sent if record[0] in ("map_update", "position")])


if __name__ == "__main__":
    rostest.rosrun("map_merger", "base_station", BaseStationTest)
