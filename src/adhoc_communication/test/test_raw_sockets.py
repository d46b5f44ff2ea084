#!/usr/bin/env python3
"""Raw sockets between network namespaces, one ROS master per robot, the radio daemon in between.

Run by catkin; by hand: /usr/bin/python3 test_raw_sockets.py [-k test_name]
"""

import os
import sys
import tempfile
import time
import unittest

import pytest
from namespaces import Robot, Team, Unavailable, enter_own_network, program, wait_until

pytestmark = pytest.mark.skipif("ADHOC_TEST_SKIP" in os.environ, reason=os.environ.get("ADHOC_TEST_SKIP", ""))

CHAIN_OF_THREE = [("robot_0", "robot_1"), ("robot_1", "robot_2")]
#: robot_0 reaches robot_3 through robot_1 or robot_2.
DIAMOND = [("robot_0", "robot_1"), ("robot_0", "robot_2"), ("robot_1", "robot_3"), ("robot_2", "robot_3")]

AROUND_THE_WALL = {"robot_0": (-5, 0), "robot_1": (0, 15), "robot_2": (5, 0)}
#: 10 m long, of an image of 1 x 10 pixels.
WALL = ["--walls-resolution", "1", "--walls-origin", "-0.5,-5", "--wall-attenuation", "30"]
ONE_CHANNEL = ["--contention", "true", "--bit-rate", "6e6", "--p-tx", "10"]  # range 19.9 m


def text_in(message):
    """`data` of a serialised RecvString."""
    octets = bytes.fromhex(message["octets_hex"])
    source_length = int.from_bytes(octets[:4], "little")
    return octets[4 : 4 + source_length].decode(), octets[8 + source_length :].decode()


class TwoMasters(unittest.TestCase):
    def test_strings_both_ways_and_a_map(self):
        with Team(["robot_0", "robot_1"], loss=0.1) as team:
            team.wait_for_robots()
            for here, there in (("robot_0", "robot_1"), ("robot_1", "robot_0")):
                team[there].agent.listen("greeting")
                answer = team[here].agent.call("send_string", dst_robot=there, topic="greeting", data=f"from {here}")
                self.assertEqual(answer.get("response"), {"status": 1}, answer)
                self.assertEqual(text_in(team[there].agent.next_message()), (here, f"from {here}"))
            expect_map(self, team["robot_0"], team["robot_1"])

    def test_absent_robot_is_a_reasoned_failure(self):
        with Team(["robot_0", "robot_1"]) as team:
            team.wait_for_robots()
            slow = team["robot_0"].agent.begin(
                do="call", service="send_string", fields={"dst_robot": "robot_9", "topic": "greeting", "data": "x"}
            )
            quick = team["robot_0"].agent.call("get_neighbors")
            self.assertEqual(quick["response"], {"neigbors": ["robot_1"]})
            self.assertTrue(slow.empty(), "the query waited for the send")
            self.assertIn("robot_9", slow.get(timeout=20)["error"])

    def test_interface_down_and_back(self):
        with Team(["robot_0", "robot_1"]) as team:
            team.wait_for_robots()
            robot = team["robot_1"]
            robot.run(["ip", "link", "set", "radio0", "down"])
            failure = robot.agent.call("send_string", dst_robot="robot_0", topic="greeting", data="x")
            self.assertIn("error", failure)
            robot.run(["ip", "link", "set", "radio0", "up"])
            team.wait_for_robots()
            team["robot_0"].agent.listen("greeting")
            answer = robot.agent.call("send_string", dst_robot="robot_0", topic="greeting", data="back")
            self.assertEqual(answer.get("response"), {"status": 1}, answer)
            self.assertIsNone(robot.node.poll())


def expect_map(test, sender, receiver, cells=1000):
    """A map of cells x cells octets arrives bit for bit."""
    receiver.agent.listen("map_from_afar")
    sent = sender.agent.ask(do="send_map", dst_robot=receiver.name, topic="map_from_afar", seed=7, cells=cells)
    test.assertIsNone(sent["error"])
    received = receiver.agent.next_message()
    test.assertEqual(received["md5"], sent["md5"])
    test.assertEqual(received["latched"], "1")


class ThreeMasters(unittest.TestCase):
    def test_map_over_two_hops(self):
        with Team(["robot_0", "robot_1", "robot_2"], loss=0.1, links=CHAIN_OF_THREE) as team:
            team.wait_for_robots()
            expect_map(self, team["robot_0"], team["robot_2"])
            hops = team["robot_2"].agent.ask(do="status")
            self.assertNotIn("robot_0", hops["neighbors"])


class OneChannelAndAWall(unittest.TestCase):
    """robot_0 and robot_2 are 10 m apart, a wall between them; robot_1 sees both past its end. All share 6 Mbit/s."""

    def test_map_goes_around_the_wall(self):
        with tempfile.NamedTemporaryFile(suffix=".pgm") as image:
            image.write(b"P5 1 10 255\n" + bytes(10))
            image.flush()
            options = ["--walls", image.name, *WALL, *ONE_CHANNEL]
            with Team(list(AROUND_THE_WALL), radio_options=options, positions=AROUND_THE_WALL) as team:
                team.wait_for_robots()
                team.wait_for_neighbors("robot_0", {"robot_1"})
                team.wait_for_neighbors("robot_2", {"robot_1"})
                expect_map(self, team["robot_0"], team["robot_2"], cells=200)
                team.radio_control.send("position robot_1 0 500")
                team.wait_for_neighbors("robot_0", set())
                team.radio_control.send("position robot_0 0 495")
                team.wait_for_neighbors("robot_0", {"robot_1"})


class FourMasters(unittest.TestCase):
    def test_killed_relay_is_replaced(self):
        with Team(["robot_0", "robot_1", "robot_2", "robot_3"], links=DIAMOND) as team:
            team.wait_for_robots()
            team["robot_3"].agent.listen("count")
            self.assert_delivered(team, 0)
            team["robot_1"].node.kill()
            begin = time.monotonic()
            self.assert_delivered(team, 1)
            self.assert_delivered(team, 2)
            self.assertLess(time.monotonic() - begin, 5.0)

    def assert_delivered(self, team, number):
        answer = team["robot_0"].agent.call("send_string", dst_robot="robot_3", topic="count", data=str(number))
        self.assertEqual(answer.get("response"), {"status": 1}, answer)
        self.assertEqual(text_in(team["robot_3"].agent.next_message()), ("robot_0", str(number)))


class ThreeNodesOnLo(unittest.TestCase):
    """simulation_mode: one master, one interface, a channel model fed by ground truth."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.host = Robot("host", self.folder.name)
        self.addCleanup(self.host.stop)
        self.host.start_master()
        self.host.wait_for_master()
        for number in range(3):
            command = [program("adhoc_communication"), f"__name:=radio_{number}", f"_robot_name:=robot_{number}"]
            self.host.start([*command, "_interface:=lo", "_simulation_mode:=true", "_p_tx:=1"])
        self.agent = self.host.start_agent()
        for number in range(3):
            self.agent.ask(do="ready", service=f"/robot_{number}/adhoc_communication/get_neighbors")

    def neighbors(self, robot):
        answer = self.agent.call(f"/{robot}/adhoc_communication/get_neighbors")
        return set(answer["response"]["neigbors"])

    def test_positions_decide_who_hears_whom(self):
        self.assertEqual(self.neighbors("robot_1"), set())  # no positions yet
        for robot, x in (("robot_0", 0.0), ("robot_1", 10.0), ("robot_2", 20.0)):
            self.agent.ask(do="place", robot=robot, x=x, y=0.0)
        wait_until(lambda: self.neighbors("robot_1") == {"robot_0", "robot_2"}, 20, "the one in the middle hears both")
        wait_until(lambda: self.neighbors("robot_0") == {"robot_1"}, 20, "robot_0 hears one")
        self.agent.listen("/robot_2/greeting")
        fields = {"dst_robot": "robot_2", "topic": "greeting", "data": "over two hops"}
        answer = self.agent.call("/robot_0/adhoc_communication/send_string", **fields)
        self.assertEqual(answer.get("response"), {"status": 1}, answer)
        self.assertEqual(text_in(self.agent.next_message()), ("robot_0", "over two hops"))


def main():
    """pytest inside an own network namespace; a skip where there is none, a failure if CI demands the tests."""
    try:
        enter_own_network()
    except Unavailable as reason:
        if os.environ.get("CI") or os.environ.get("REQUIRE_RAW_SOCKETS"):
            sys.exit(f"raw-socket tests are required and cannot run: {reason}")
        os.environ["ADHOC_TEST_SKIP"] = str(reason)
    return pytest.main([__file__, "--verbose", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
