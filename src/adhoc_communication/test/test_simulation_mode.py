#!/usr/bin/env python3
"""simulation_mode under one master: three nodes share lo by distinct addresses, ground truth decides who hears whom.

Skipped where the node may not open raw sockets, unless CI or REQUIRE_RAW_SOCKETS is set: then it fails.
"""

import os
import subprocess
import tempfile
import threading
import unittest
from pathlib import Path

import rospy
import rostest
from adhoc_communication import msg, srv
from namespaces import die_with_parent, program, wait_until
from nav_msgs.msg import Odometry
from std_msgs.msg import String

ROBOTS = ("robot_0", "robot_1", "robot_2")
P_TX = 1  # dBm: a range of 11.9 m
#: Drawn for each run, so that runs at the same time on the same lo do not hear each other.
ADDRESSES = {name: "02:" + os.urandom(4).hex(":") + f":{number:02x}" for number, name in enumerate(ROBOTS)}


class Listener:
    """All messages of a topic, from before the first on."""

    def __init__(self, topic, message_class):
        self._changed = threading.Condition()
        self.messages = []
        rospy.Subscriber(topic, message_class, self._store)

    def _store(self, message):
        with self._changed:
            self.messages.append(message)
            self._changed.notify_all()

    def wait_for(self, condition, what, timeout=30.0):
        """Wait until `condition(messages)` holds."""
        with self._changed:
            assert self._changed.wait_for(lambda: condition(self.messages), timeout), f"{what}: {self.messages[-5:]}"

    def forget(self):
        with self._changed:
            self.messages.clear()

    def wait_for_names(self, names, timeout=30.0):
        expected = set(names)
        self.wait_for(lambda all_of: expected <= {message.data for message in all_of}, f"{names} named", timeout)


class Node:
    """A node on lo, as a launch file would start it."""

    def __init__(self, name, folder):
        self.name = name
        self.log = Path(folder) / f"{name}.log"
        everybody = "!".join(f"{robot},{address}" for robot, address in ADDRESSES.items())
        parameters = {
            "interface": "lo", "robot_name": name, "mac": ADDRESSES[name], "sim_robot_macs": everybody,
            "simulation_mode": "true", "robots_in_simulation": len(ROBOTS), "p_tx": P_TX,
        }  # fmt: skip
        command = [program("adhoc_communication"), f"__name:=radio_of_{name}"]
        command += [f"_{parameter}:={value}" for parameter, value in parameters.items()]
        with self.log.open("w") as log:
            self.process = subprocess.Popen(command, stdout=log, stderr=log, preexec_fn=die_with_parent)

    def prefixed(self, name):
        return f"/{self.name}/adhoc_communication/{name}"

    def is_ready(self):
        """Its services answer; SkipTest or AssertionError if the node ended instead."""
        if self.process.poll() is not None:
            refuse_or_skip(self.log.read_text())
        try:
            rospy.wait_for_service(self.prefixed("get_neighbors"), timeout=0.1)
        except rospy.ROSException:
            return False
        return True

    def neighbors(self):
        return set(rospy.ServiceProxy(self.prefixed("get_neighbors"), srv.GetNeighbors)().neigbors)

    def send(self, destination, text):
        call = rospy.ServiceProxy(self.prefixed("send_string"), srv.SendString)
        return call(dst_robot=destination, topic="greeting", data=text).status

    def stop(self):
        self.process.terminate()
        self.process.wait(timeout=20)


def refuse_or_skip(output):
    required = os.environ.get("CI") or os.environ.get("REQUIRE_RAW_SOCKETS")
    if "cap_net_raw" in output and not required:
        raise unittest.SkipTest(output)
    raise AssertionError(f"a node ended:\n{output}")


class ThreeNodesOnLo(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.truth = {
            name: rospy.Publisher(f"/{name}/base_pose_ground_truth", Odometry, queue_size=1, latch=True)
            for name in ROBOTS
        }
        cls.nodes = {}
        for name in ROBOTS:
            try:
                cls.nodes[name] = Node(name, folder.name)
            except PermissionError as error:  # a capability that this container does not have at all
                refuse_or_skip(f"cap_net_raw: {error}")
            cls.addClassCleanup(cls.nodes[name].stop)
        for node in cls.nodes.values():
            wait_until(node.is_ready, 30, f"{node.name} is ready")

    def setUp(self):
        self.status = {name: Listener(node.prefixed("status"), msg.Status) for name, node in self.nodes.items()}
        self.found = {name: Listener(node.prefixed("new_robot"), String) for name, node in self.nodes.items()}
        self.lost = {name: Listener(node.prefixed("remove_robot"), String) for name, node in self.nodes.items()}
        self.received = Listener("/robot_2/greeting", msg.RecvString)

    def place(self, **coordinates):
        for name, x in coordinates.items():
            odometry = Odometry()
            odometry.pose.pose.position.x = x
            self.truth[name].publish(odometry)

    def wait_for_neighbors(self, **expected):
        for name, neighbors in expected.items():
            wait_until(lambda: self.nodes[name].neighbors() == neighbors, 20, f"{name} hears exactly {neighbors}")  # noqa: B023

    def wait_for_hops(self, expected):
        """Of the packets that robot_2 received, `expected[i]` came over i + 1 hops."""
        self.status["robot_2"].wait_for(
            lambda all_of: all_of and trimmed(all_of[-1].packets_received_by_hops) == expected,
            f"packets received by hops are {expected}",
        )

    def test_ground_truth_decides_who_hears_whom(self):
        self.nobody_is_heard_without_positions()
        self.a_message_takes_two_hops()
        self.robots_out_of_range_are_lost()
        self.robots_that_return_are_found()

    def nobody_is_heard_without_positions(self):
        for name, status in self.status.items():
            status.wait_for(lambda all_of: all_of and all_of[-1].frames_sent >= 10, f"{name} has sent beacons")
            self.assertEqual(self.nodes[name].neighbors(), set())
        self.assertEqual(self.found["robot_1"].messages, [])

    def a_message_takes_two_hops(self):
        self.place(robot_0=0.0, robot_1=10.0, robot_2=20.0)
        self.wait_for_neighbors(robot_0={"robot_1"}, robot_1={"robot_0", "robot_2"}, robot_2={"robot_1"})
        self.assertEqual(self.nodes["robot_0"].send("robot_2", "over two hops"), 1)
        self.received.wait_for(lambda all_of: all_of, "the message arrives")
        self.assertEqual([(m.src_robot, m.data) for m in self.received.messages], [("robot_0", "over two hops")])
        self.wait_for_hops([0, 1])
        self.assertEqual(self.nodes["robot_1"].send("robot_2", "over one hop"), 1)
        self.wait_for_hops([1, 1])
        self.assertEqual(self.nodes["robot_0"].neighbors(), {"robot_1"})

    def robots_out_of_range_are_lost(self):
        self.found["robot_0"].wait_for_names({"robot_1", "robot_2"})
        self.place(robot_1=500.0, robot_2=510.0)
        self.lost["robot_0"].wait_for_names({"robot_1", "robot_2"})
        self.lost["robot_1"].wait_for_names({"robot_0"})
        self.lost["robot_2"].wait_for_names({"robot_0"})
        self.assertEqual(self.nodes["robot_0"].neighbors(), set())
        self.assertEqual(self.nodes["robot_1"].neighbors(), {"robot_2"})  # they went together
        self.assertNotIn("robot_2", {message.data for message in self.lost["robot_1"].messages})
        with self.assertRaisesRegex(rospy.ServiceException, "no route to robot_2"):
            self.nodes["robot_0"].send("robot_2", "into the void")

    def robots_that_return_are_found(self):
        self.found["robot_0"].forget()
        self.place(robot_1=10.0, robot_2=20.0)
        self.found["robot_0"].wait_for_names({"robot_1", "robot_2"})
        self.assertEqual(self.nodes["robot_0"].send("robot_2", "again"), 1)
        self.wait_for_hops([1, 2])


def trimmed(counts):
    """Without the zeros at the end."""
    counts = list(counts)
    while counts and counts[-1] == 0:
        counts.pop()
    return counts


def setUpModule():
    rospy.init_node("test_simulation_mode")


if __name__ == "__main__":
    rostest.rosrun("adhoc_communication", "simulation_mode", "__main__")
