#!/usr/bin/env python3
"""The real node among adversaries who know its tables: forged sizes, bombs, recorded runs, frames without end.

Those who forge use the Python implementation of the protocol (test/twin), and one test is an honest robot of that kind.
"""

import itertools
import os
import random
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import zlib
from pathlib import Path
from typing import ClassVar, Dict

import rospy
import rostest
import zstandard
from adhoc_communication.msg import RecvString
from adhoc_communication.srv import GetNeighbors, SendString
from std_msgs.msg import String

sys.path.insert(0, str(Path(__file__).resolve().parent / "twin"))
sys.path.insert(0, str(Path(__file__).resolve().parent))

import frames
from captures import capture
from namespaces import die_with_parent, program
from robot import BEACON, DATA, Robot

FLOOD = 9
COMPRESSED, LATCHED = 1, 2
PATIENCE = 20.0  # s
MOST_RESIDENT = 64  # MB
LARGEST_PACKET = 10_000_000
ALICE, BOB, TWIN = (bytes([2, 0, 0, 0, 0, number]) for number in (1, 2, 3))
ETHERTYPE = b"\x88\xb5"


class Node:
    """A robot's node, started by the test."""

    def __init__(self, name, address, stderr=None, **parameters):
        self.name, self.address = name, address
        values = {
            "robot_name": name,
            "interface": "hub:" + rospy.get_param("~hub"),
            "mac": address.hex(":"),
            **parameters,
        }
        arguments = [f"_{key}:={value}" for key, value in values.items()]
        command = [program("adhoc_communication"), f"__ns:={name}", *arguments]
        self.process = subprocess.Popen(command, preexec_fn=die_with_parent, stderr=stderr)

    def service(self, service, service_type):
        name = f"/{self.name}/adhoc_communication/{service}"
        rospy.wait_for_service(name, timeout=PATIENCE)
        return rospy.ServiceProxy(name, service_type)

    def send(self, destination, data, topic="greeting"):
        return self.service("send_string", SendString)(destination, topic, data).status

    def hears(self, other):
        return other in self.service("get_neighbors", GetNeighbors)().neigbors

    def most_resident(self):
        """MB, since its start."""
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(status.split("VmHWM:")[1].split()[0]) / 1000

    def end(self):
        """Seconds that it took."""
        begin = time.monotonic()
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(timeout=PATIENCE)
        return time.monotonic() - begin


class Station:
    """Takes part in the radio by the hub's socket: whole Ethernet frames, of any sender."""

    def __init__(self, name):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.socket.connect(rospy.get_param("~hub"))
        self.socket.send(name.encode())

    def send(self, destination, source, octets):
        self.socket.send(destination + source + ETHERTYPE + octets)


class Stranger:
    """A run of a robot that there is not; every frame is well formed."""

    count = 0

    def __init__(self, station):
        Stranger.count += 1
        self.station, self.counter = station, 0
        self.address = bytes([2, 6, 6, 6, *divmod(Stranger.count, 256)])
        self.name = f"stranger_{Stranger.count}"
        self.boot_id = bytes([*divmod(Stranger.count, 256)]) * 8

    def say(self, kind, fields):
        self.counter += 1
        header = {"version": 2, "type": kind, "flags": 0, "sender": self.address, "boot_id": self.boot_id,
                  "counter": self.counter, "next_hop": frames.EVERYBODY, "link_sequence": 0}  # fmt: skip
        self.station.send(frames.EVERYBODY, self.address, frames.close(header, fields))

    def beacon(self, rumors=()):
        self.say(BEACON, {"sequence": 1, "life_sign": 1, "number": self.counter, "name": self.name,
                          "heard_count": 0, "heard": [], "rumors": list(rumors), "extensions": {}})  # fmt: skip

    def segment(self, destination, packet, total, octets, priority=2):
        self.say(DATA, {"source": self.address, "source_boot_tag": self.boot_id[:8], "destination": destination,
                        "stream": priority, "hops": 1, "packet": packet, "base": packet, "index": 0, "total": total,
                        "segment_size": min(1386, total), "attempt": 0, "octets": octets})  # fmt: skip

    def flood(self, number, image):
        self.say(FLOOD, {"source": self.address, "source_boot_tag": self.boot_id[:8], "id": number, "hop_count": 0,
                         "hop_limit": 1, "source_name": self.name, "image": image})  # fmt: skip


def bomb(topic, content, flags=0, payload_type="A"):
    """Megabytes in a packet of some hundred octets."""
    packed = zstandard.ZstdCompressor(level=19).compress(content)
    image = {
        "flags": COMPRESSED | flags,
        "kind": 0,
        "payload_type": ord(payload_type),
        "group": "",
        "topic": topic,
        "payload_size": len(content),
    }
    return frames.write(frames.IMAGE, {**image, "payload": packed})


def wait_until(condition, what):
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, what
        time.sleep(0.05)


class Received:
    """Texts of a topic, in order."""

    def __init__(self, topic, message_class=RecvString):
        self.texts, self._arrived = [], threading.Condition()
        self._subscriber = rospy.Subscriber(topic, message_class, self._take)

    def _take(self, message):
        with self._arrived:
            self.texts.append(message.data)
            self._arrived.notify_all()

    def wait_for(self, text):
        with self._arrived:
            assert self._arrived.wait_for(lambda: text in self.texts, PATIENCE), [text[:40] for text in self.texts]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._subscriber.unregister()


class Background:
    """Does something again and again, until the end of the block."""

    def __init__(self, action):
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(action,))

    def _run(self, action):
        while not self._stopping.is_set():
            action()

    def __enter__(self):
        self._thread.start()

    def __exit__(self, *_):
        self._stopping.set()
        self._thread.join()


def setUpModule():
    rospy.init_node("test_hostile")


class Pair(unittest.TestCase):
    """Two robots that exchange texts all the same."""

    parameters: ClassVar[Dict[str, object]] = {}

    @classmethod
    def setUpClass(cls):
        cls.alice = Node("alice", ALICE, **cls.parameters)
        cls.bob = Node("bob", BOB, **cls.parameters)
        cls.meet()

    @classmethod
    def meet(cls):
        wait_until(lambda: cls.alice.hears("bob") and cls.bob.hears("alice"), "the robots do not find each other")

    @classmethod
    def tearDownClass(cls):
        for node in (cls.alice, cls.bob):
            node.end()

    def check_exchange(self, octets=500_000):
        """Returns the text that has gone both ways."""
        text = f"{random.getrandbits(4 * octets):0{octets}x}"
        with Received("/there") as there, Received("/back") as back:
            self.assertEqual(self.alice.send("bob", text, "/there"), 1)
            self.assertEqual(self.bob.send("alice", text, "/back"), 1)
            there.wait_for(text)
            back.wait_for(text)
        return text


class Open(Pair):
    def test_forged_sizes_block_no_packet(self):
        station = Station("forger")
        for _ in range(60):
            stranger = Stranger(station)
            stranger.beacon()
            for priority in range(4):
                stranger.segment(BOB, 1, LARGEST_PACKET - 100, bytes(1386), priority)
        self.check_exchange()
        self.assertLess(self.bob.most_resident(), MOST_RESIDENT)

    def test_claims_of_other_runs_deafen_nobody(self):
        stranger, runs = Stranger(Station("liar")), itertools.count(1)

        def claim():
            run = next(runs).to_bytes(8, "big")
            stranger.beacon(
                {"address": address, "boot_tag": run, "life_sign": 1_000_000, "hops": 1, "name": name}
                for address, name in ((ALICE, "alice"), (BOB, "bob"))
            )
            time.sleep(0.002)

        with Received("/bob/adhoc_communication/remove_robot", String) as lost, Background(claim):
            for _ in range(10):
                self.check_exchange(10_000)
            self.assertNotIn("alice", lost.texts)

    def test_bombs_take_little_memory(self):
        stranger = Stranger(Station("bomber"))
        stranger.beacon()
        image = bomb("bombed", bytes(9_900_000))
        self.assertLess(len(image), 1386)
        for number in range(100):
            stranger.flood(number, image)
            stranger.segment(BOB, number, len(image), image)
        self.check_exchange()
        self.assertLess(self.bob.most_resident(), MOST_RESIDENT)

    def test_latched_bombs_take_little_memory(self):
        station = Station("latching_bomber")
        for number in range(60):  # of many robots, each on a topic of its own
            if number % 4 == 0:
                stranger = Stranger(station)
                stranger.beacon()
            topic = f"/bombed_{number}"
            image = bomb(topic, bytes((9_900_000, 6_900_000, 2_900_000)[number % 3]), LATCHED)
            stranger.segment(BOB, number, len(image), image)
            wait_until(lambda name=topic: [name, RecvString._type] in rospy.get_published_topics(), topic)
        with Received(topic) as latched:
            wait_until(lambda: latched.texts, "the newest is not kept")
            self.assertEqual(len(latched.texts[0]), 2_900_000)
        self.check_exchange()
        self.assertLess(self.bob.most_resident(), MOST_RESIDENT)

    def test_messages_that_wait_for_a_definition_take_little_memory(self):
        station = Station("undefined")
        for number in range(40):
            stranger = Stranger(station)
            stranger.beacon()
            names = b"".join(len(text).to_bytes(4, "little") + text for text in (b"a/Type%d" % number, b"0" * 32))
            image = bomb(f"/undefined_{number}", names + bytes(9_900_000), payload_type="x")
            stranger.segment(BOB, 1, len(image), image)
        self.check_exchange()
        self.assertLess(self.bob.most_resident(), MOST_RESIDENT)

    def test_frames_without_end_stop_nothing(self):
        station, generator = Station("babbler"), random.Random(1)

        def babble():
            sender = bytes([2, 6, 6, 7, 0, generator.randrange(256)])
            body = generator.getrandbits(8 * 400).to_bytes(400, "big")
            head = bytes([2, generator.randrange(1, 15), generator.randrange(8)]) + sender + body[:24]
            octets = head + frames.EVERYBODY + body[:200]
            station.send(frames.EVERYBODY, sender, octets + zlib.crc32(octets).to_bytes(4, "big"))

        with Background(babble):
            self.check_exchange()
            self.assertLess(self.bob.end(), 5.0)
        type(self).bob = Node("bob", BOB, **self.parameters)
        self.meet()

    def test_a_robot_with_another_implementation(self):
        station, using = Station("twin"), threading.Lock()
        twin = Robot("twin", TWIN, os.urandom(16), time.monotonic_ns())

        def live():
            ready, _, _ = select.select([station.socket], [], [], 0.001)
            octets = station.socket.recv(65536) if ready else b""
            with using:
                if octets:
                    twin.receive(octets[:6], octets[6:12], octets[14:], time.monotonic_ns())
                for destination, frame in twin.poll(time.monotonic_ns()):
                    station.send(destination, TWIN, frame)

        with Background(live), Received("/from_twin") as received:
            wait_until(lambda: self.alice.hears("twin"), "the twin is not heard")
            self.assertEqual(self.alice.send("twin", "to the twin", "topic"), 1)
            with using:
                self.assertEqual([packet[:3] for packet in twin.packets], [("alice", "topic", b"to the twin")])
                twin.send("bob", "/from_twin", b"from the twin")
            received.wait_for("from the twin")


class Sealed(Pair):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="adhoc_hostile_"))
        key = cls.folder / "team.key"
        subprocess.run(
            ["rosrun", "adhoc_communication", "team_key", "create", str(key)], check=True, stdout=subprocess.DEVNULL
        )
        cls.capture = cls.folder / "air.pcap"
        cls.parameters = {"key_file": str(key), "require_key": "true"}
        cls.alice = Node("alice", ALICE, capture_file=cls.capture, **cls.parameters)
        cls.bob = Node("bob", BOB, **cls.parameters)
        cls.meet()

    @classmethod
    def tearDownClass(cls):
        super().tearDownClass()
        shutil.rmtree(cls.folder)

    def test_recorded_runs_change_nothing(self):
        self.check_exchange(10_000)
        with Received("/alice/adhoc_communication/remove_robot", String) as lost:
            self.bob.end()
            type(self).bob = Node("bob", BOB, **self.parameters)
            self.meet()
            lost.wait_for("bob")  # its former run; said once the new one is heard, or its silence was long enough
        recorded = list(capture(self.capture))
        station, again = Station("player"), itertools.cycle(recorded)

        def play():
            frame = next(again)
            station.send(frame.destination, frame.source, frame.octets)

        with Received("/alice/adhoc_communication/remove_robot", String) as lost, Received("/there") as there:
            for _ in recorded:
                play()
            with Background(play):
                sent = [self.check_exchange(10_000) for _ in range(10)]
            self.assertEqual((lost.texts, there.texts), ([], sent))


class Alone(unittest.TestCase):
    def said_by_a_robot(self, name, **parameters):
        """Warnings about the key of a node from its start until after its first answer."""
        with tempfile.TemporaryFile("w+") as said:
            node = Node(name, TWIN, stderr=said, **parameters)
            node.service("get_neighbors", GetNeighbors)()
            node.service("get_neighbors", GetNeighbors)()
            node.end()
            said.seek(0)
            return [line for line in said if "neither encrypted nor authenticated" in line]

    def test_an_open_node_says_so_once_at_start(self):
        self.assertEqual(len(self.said_by_a_robot("open")), 1)

    def test_a_sealed_node_does_not(self):
        with tempfile.TemporaryDirectory() as folder:
            key = Path(folder) / "team.key"
            subprocess.run(
                ["rosrun", "adhoc_communication", "team_key", "create", str(key)], check=True, stdout=subprocess.DEVNULL
            )
            self.assertEqual(self.said_by_a_robot("sealed", key_file=key), [])


if __name__ == "__main__":
    rostest.rosrun("adhoc_communication", "hostile", "__main__")
