#!/usr/bin/env python3
"""Everything robot_0 sent in the recording is sent again and has to come out at robot_1 as it did then."""

import sys
import time
import unittest
from typing import Any, List

import rospy
import rostest
from adhoc_communication import msg, srv
from comparison import differences, plain, report, stored
from nav_msgs.msg import OccupancyGrid
from playback import DEADLINE_S, FOLDER, Collection, Listener, played, wait_until

GROUP = "mc_robot_0"
SERVICES = {  # topic: (service, its type, field of the message, type of the message, destination)
    "map_other": ("send_map_update", srv.SendMmMapUpdate, "map_update", msg.MmMapUpdate, GROUP),
    "map_meta_other": ("send_map", srv.SendOccupancyGrid, "map", OccupancyGrid, GROUP),
    "control": ("send_control_message", srv.SendMmControl, "msg", msg.MmControl, "robot_1"),
    "position_other_robots": ("send_position", srv.SendMmRobotPosition, "position", msg.MmRobotPosition, GROUP),
    "frontiers": ("send_frontier", srv.SendExpFrontier, "frontier", msg.ExpFrontier, GROUP),
    "auction": ("send_auction", srv.SendExpAuction, "auction", msg.ExpAuction, GROUP),
}


class Sender:
    """Hands what is played on a topic to robot_0's radio, one message after the other."""

    def __init__(self, topic: str) -> None:
        name, service_class, self._field, message_class, self._destination = SERVICES[topic]
        self._topic = topic
        self._service = rospy.ServiceProxy(f"/robot_0/adhoc_communication/{name}", service_class)
        self.answers = Collection()
        self._subscriber = rospy.Subscriber(f"/played/{topic}", message_class, self._send)

    def _send(self, message: Any) -> None:
        try:
            answer = self._service(**{"dst_robot": self._destination, "topic": self._topic, self._field: message})
            self.answers.add(answer.status)
        except rospy.ServiceException as error:
            self.answers.add(str(error))


class AdhocCommunication(unittest.TestCase):
    def test_what_was_sent_comes_out_as_it_did(self) -> None:
        expected = stored(FOLDER / "adhoc_communication.expected.bag")
        self.assertEqual(set(expected), set(SERVICES), "topics of the stored expectation")
        injected = {topic: Listener(f"/robot_1/{topic}", SERVICES[topic][3]) for topic in expected}
        self.wait_for_the_group()
        senders = {topic: Sender(topic) for topic in expected}
        with played(rospy.get_param("~bag"), "--prefix=/played/", "--rate=20"):
            self.deadline = time.monotonic() + DEADLINE_S
            for topic, messages in expected.items():
                self.wait_for(len(messages), injected[topic], senders[topic].answers)
        lines: List[str] = []
        for topic, messages in expected.items():
            lines += differences(messages, [plain(message) for message in injected[topic].entries], 0.0, topic)
            answers = senders[topic].answers.entries
            lines += differences([1] * len(messages), answers, 0.0, f"answers to the sends on {topic}")
        if lines:
            self.fail(report("what came out at robot_1", lines))

    def wait_for(self, count: int, *collections: Collection) -> None:
        for collection in collections:
            collection.wait_for(lambda entries: len(entries) >= count, self.deadline - time.monotonic())

    def wait_for_the_group(self) -> None:
        """Until robot_1 is a member of robot_0's group, as far as robot_0 knows."""
        state = rospy.ServiceProxy("/robot_0/adhoc_communication/get_group_state", srv.GetGroupState)
        state.wait_for_service(20)
        wait_until(lambda: "robot_1" in state(group_name=GROUP).downlinks, "robot_1 in the group of robot_0")


if __name__ == "__main__":
    rospy.init_node("adhoc_communication_rostest")
    rostest.rosrun("mr_test", "playback_adhoc_communication", AdhocCommunication, sys.argv)
