#!/usr/bin/env python3
"""Raw sockets between network namespaces, one ROS master per robot, the radio daemon in between.

Run by catkin; by hand: /usr/bin/python3 test_raw_sockets.py [-k test_name]
"""

import ctypes
import errno
import os
import pathlib
import select
import socket
import stat
import sys
import tempfile
import time
import unittest

import pytest
from namespaces import Robot, Team, Unavailable, enter_own_network, program, wait_until

LIBC = ctypes.CDLL(None, use_errno=True)

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


ETHERTYPE = 0x88B5
PACKET_OUTGOING = 4
PIDFD_GETFD = 438  # a system call without a function in Python


class FramesOf:
    """What a robot sends from now on, as whole Ethernet frames, at the radio's end of its cable."""

    def __init__(self, cable):
        self._socket = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETHERTYPE))
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 16_000_000)
        self._socket.bind((cable, ETHERTYPE))
        self._socket.setblocking(False)
        self._frames = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._socket.close()

    def so_far(self):
        while select.select([self._socket], [], [], 0)[0]:
            octets, address = self._socket.recvfrom(65536)
            if address[2] != PACKET_OUTGOING:
                self._frames.append(octets)
        return self._frames


def begin_map(robot, to, cells=1000):
    return robot.agent.begin(do="send_map", dst_robot=to, topic="map_from_afar", seed=7, cells=cells)


class ChangedInterface(unittest.TestCase):
    """As by NetworkManager, or by a replugged radio."""

    ADDRESS, MTU = "02:00:00:00:09:09", 1200

    def test_another_address_and_mtu_while_maps_are_under_way(self):
        with Team(["robot_0", "robot_1"], radio_options=["--bit-rate", "2e6"]) as team:
            team.wait_for_robots()
            here, there = team["robot_0"], team["robot_1"]
            here.agent.listen("adhoc_communication/remove_robot")
            with FramesOf("air1") as frames:
                under_way = begin_map(there, "robot_0")  # 4 s of air
                wait_until(lambda: any(len(frame) > 1400 for frame in frames.so_far()), 20, "the map is under way")
            there.run(["ip", "link", "set", "radio0", "address", self.ADDRESS, "mtu", str(self.MTU)])
            self.assertIn("the interface has changed", under_way.get(timeout=20)["error"])
            self.assertIn("robot_1", bytes.fromhex(here.agent.next_message()["octets_hex"]).decode())
            team.wait_for_robots()
            with FramesOf("air1") as frames:
                expect_map(self, there, here, cells=200)
                sent = frames.so_far()
            self.assertEqual({frame[6:12].hex(":") for frame in sent}, {self.ADDRESS})
            longest = max(len(frame) for frame in sent)
            self.assertLessEqual(longest, self.MTU + 14)
            self.assertGreater(longest, self.MTU - 100)
            there.agent.listen("greeting")
            answer = here.agent.call("send_string", dst_robot="robot_1", topic="greeting", data="again")
            self.assertEqual(answer.get("response"), {"status": 1}, answer)
            self.assertEqual(text_in(there.agent.next_message()), ("robot_0", "again"))
            self.assertIsNone(there.node.poll())


class EndUnderLoad(unittest.TestCase):
    def test_every_call_ends_with_a_reason_and_the_node_at_once(self):
        with Team(["robot_0", "robot_1"], radio_options=["--bit-rate", "1e6"]) as team:
            team.wait_for_robots()
            here, there = team["robot_0"], team["robot_1"]
            under_way = [begin_map(here, destination) for destination in ("robot_1", "mc_robot_0", "robot_1")]
            under_way.append(begin_map(there, "robot_0"))
            for robot, packets in ((here, 3), (there, 1)):
                wait_until(
                    lambda robot=robot, packets=packets: robot.agent.ask(do="packets_waiting")["packets"] >= packets,
                    20,
                    "all are under way",
                )
            begin = time.monotonic()
            here.node.terminate()
            self.assertEqual(here.node.wait(timeout=20), 0)
            self.assertLess(time.monotonic() - begin, 5.0)
            for call in under_way[:3]:
                self.assertIn("the node is shutting down", call.get(timeout=20)["error"])
            self.assertIsNotNone(under_way[3].get(timeout=60)["error"])
            self.assertIsNone(there.node.poll())


class Bands(unittest.TestCase):
    """Which frames go by which socket is tested beside the link itself."""

    def test_the_node_has_a_socket_of_each_access_category(self):
        with Team(["robot_0"]) as team:
            self.assertEqual(sorted(priorities_of_packet_sockets(team["robot_0"].node.pid)), [0, 256 + 4, 256 + 6])


class Capabilities(unittest.TestCase):
    """Raised while sockets are opened, and else not: what takes over the node later cannot listen to other traffic."""

    NET_ADMIN, NET_RAW = 1 << 12, 1 << 13

    def test_none_is_in_effect_while_the_node_works(self):
        with Team(["robot_0", "robot_1"]) as team:
            team.wait_for_robots()
            held = capabilities_of(team["robot_0"].node.pid)
        self.assertTrue(held["CapPrm"] & self.NET_RAW, "nothing to lower")
        self.assertTrue(capabilities_of(os.getpid())["CapEff"] & self.NET_RAW, "what is in effect is seen")
        self.assertFalse(held["CapEff"] & (self.NET_RAW | self.NET_ADMIN))


def capabilities_of(pid):
    """Sets of the process, as bits. Any of its threads may hold other ones: all of them together."""
    held = {}
    for status in pathlib.Path(f"/proc/{pid}/task").glob("*/status"):
        for line in status.read_text().splitlines():
            name, _, value = line.partition(":")
            if name.startswith("Cap"):
                held[name] = held.get(name, 0) | int(value, 16)
    return held


def priorities_of_packet_sockets(pid):
    """SO_PRIORITY of each packet socket of another process."""
    process = os.pidfd_open(pid)
    priorities = []
    for number in map(int, os.listdir(f"/proc/{pid}/fd")):
        copy = LIBC.syscall(PIDFD_GETFD, process, number, 0)
        if copy < 0 and ctypes.get_errno() == errno.EBADF:
            continue  # the process has closed it since it was listed
        assert copy >= 0, os.strerror(ctypes.get_errno())
        if stat.S_ISSOCK(os.fstat(copy).st_mode):
            with socket.socket(fileno=copy) as other:
                if other.family == socket.AF_PACKET:
                    priorities.append(other.getsockopt(socket.SOL_SOCKET, socket.SO_PRIORITY))
        else:
            os.close(copy)
    os.close(process)
    return priorities


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
