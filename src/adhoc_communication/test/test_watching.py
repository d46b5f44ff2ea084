#!/usr/bin/env python3
"""Diagnostics, network state, logs on a full disk, capture, adhoc_top."""

import io
import os
import shutil
import struct
import subprocess
import threading
import time
import unittest
from pathlib import Path

import rospy
import rostest
from adhoc_communication import top
from adhoc_communication.msg import NetworkState, Status
from adhoc_communication.srv import SendString
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from namespaces import program

PATIENCE = 20.0  # s
ETHERTYPE = 0x88B5
BEACON, DATA = 1, 6


def wait_for_state(robot, condition):
    """The first NetworkState of a robot that fulfils the condition."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        state = rospy.wait_for_message(f"/{robot}/adhoc_communication/network_state", NetworkState, PATIENCE)
        if condition(state):
            return state
    raise AssertionError(f"not within {PATIENCE} s: {state}")


def diagnostics(robot, condition):
    """The parts of a report of this robot, by their short names, that fulfil the condition together."""
    found, arrived = {}, threading.Event()
    prefix = f"adhoc_communication {robot}: "

    def take(array):
        parts = {part.name[len(prefix) :]: part for part in array.status if part.name.startswith(prefix)}
        if parts and condition(parts) and not arrived.is_set():
            found.update(parts)
            arrived.set()

    subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, take)
    assert arrived.wait(PATIENCE), f"no such diagnostics of {robot}"
    subscriber.unregister()
    return found


def send(robot, destination, topic="greeting", data="hello"):
    name = f"/{robot}/adhoc_communication/send_string"
    rospy.wait_for_service(name, timeout=PATIENCE)
    return rospy.ServiceProxy(name, SendString)(destination, topic, data)


def setUpModule():
    rospy.init_node("test_watching")
    wait_for_state("alice", lambda state: [link.robot for link in state.links if link.two_way] == ["bob"])
    assert send("alice", "bob").status == 1


def tearDownModule():
    folder = rospy.get_param("~folder")
    for path in (folder, folder + "_full"):
        shutil.rmtree(path, ignore_errors=True)
    Path(folder + ".pcap").unlink()


class State(unittest.TestCase):
    def test_neighbours_routes_and_groups(self):
        state = wait_for_state("alice", lambda state: any(route.valid for route in state.routes))
        self.assertEqual(state.robot_name, "alice")
        self.assertTrue(state.interface_up)
        self.assertFalse(state.sealed)
        self.assertEqual([link.robot for link in state.links], ["bob"])
        self.assertTrue(state.links[0].two_way)
        route = next(route for route in state.routes if route.destination == "bob")
        self.assertEqual((route.next_hop, route.hops), ("bob", 1))
        groups = {group.group: group for group in state.groups}
        self.assertEqual(set(groups), {"mc_alice", "mc_bob"})
        self.assertTrue(groups["mc_alice"].root)
        self.assertEqual(list(groups["mc_alice"].downlinks), ["bob"])

    def test_counters_agree_with_status(self):
        before = wait_for_state("alice", lambda state: True)
        send("alice", "bob")
        after = wait_for_state("alice", lambda state: state.packets_sent > before.packets_sent)
        self.assertGreater(after.frames_sent, before.frames_sent)
        status = rospy.wait_for_message("/alice/adhoc_communication/status", Status, PATIENCE)
        self.assertEqual(status.neighbors, ["bob"])
        self.assertGreaterEqual(status.packets_sent, before.packets_sent)


class Diagnostics(unittest.TestCase):
    def test_parts_and_levels(self):
        parts = diagnostics("bob", lambda parts: True)
        expected = {"interface", "security", "neighbors", "queues", "dropped frames", "publishing", "relays", "files"}
        self.assertEqual(set(parts), expected)
        self.assertEqual(parts["interface"].level, DiagnosticStatus.OK)
        self.assertEqual(parts["security"].level, DiagnosticStatus.WARN)  # no key file
        self.assertEqual([value.key for value in parts["neighbors"].values], ["loss to alice"])

    def test_packet_that_cannot_be_published_is_seen(self):
        self.assertEqual(send("alice", "bob", topic="/rosout").status, 1)
        parts = diagnostics("bob", lambda parts: parts["publishing"].level == DiagnosticStatus.WARN)
        self.assertIn("cannot be published", parts["publishing"].message)


class WithOwnRadio(unittest.TestCase):
    def test_interface_that_goes_down_is_an_error_until_it_is_back(self):
        hub = rospy.get_param("~folder") + "_hub"
        ended = []

        def start(name, *command):
            process = subprocess.Popen([program(name), *command], stdout=subprocess.PIPE)
            ended.append(process)
            return process

        def start_radio():
            radio = start("radio", "--hub", hub)
            self.assertTrue(radio.stdout.readline().startswith(b"radio ready"))
            return radio

        try:
            radio = start_radio()
            names = ["__ns:=/erin", "__name:=adhoc_communication", "_robot_name:=erin"]
            start("adhoc_communication", *names, f"_interface:=hub:{hub}")
            wait_for_state("erin", lambda state: state.interface_up)
            radio.terminate()
            radio.wait(timeout=20)
            wait_for_state("erin", lambda state: not state.interface_up)
            parts = diagnostics("erin", lambda parts: parts["interface"].level == DiagnosticStatus.ERROR)
            self.assertEqual(f"hub:{hub} is down", parts["interface"].message)
            start_radio()
            wait_for_state("erin", lambda state: state.interface_up)
            diagnostics("erin", lambda parts: parts["interface"].level == DiagnosticStatus.OK)
        finally:
            for process in ended:
                process.terminate()
                process.wait(timeout=20)
                process.stdout.close()


class WithFullDisk(unittest.TestCase):  # the last by name, because it adds a robot
    def test_full_disk_stops_nothing_and_is_seen(self):
        """A node whose logs and capture are /dev/full works, and says what it loses."""
        folder = Path(rospy.get_param("~folder") + "_full")
        logs = folder / "adhoc_communication" / "dora"
        logs.mkdir(parents=True)
        for name in ("services", "routing_table", "packet_memory_consumption", "transport_frames"):
            (logs / f"{name}.csv").symlink_to("/dev/full")
        capture = folder / "dora.pcap"
        capture.symlink_to("/dev/full")
        hub = rospy.get_param("/alice/adhoc_communication/interface")
        parameters = {"robot_name": "dora", "interface": hub, "log_path": folder, "capture_file": capture}
        command = [program("adhoc_communication"), "__ns:=/dora", "__name:=adhoc_communication"]
        command += [f"_{name}:={value}" for name, value in parameters.items()]
        words = folder / "words"
        with words.open("w") as file:
            node = subprocess.Popen(command, stderr=file)
        try:
            wait_for_state("dora", lambda state: len(state.links) == 2)
            self.assertEqual(send("dora", "alice").status, 1)
            lost = wait_for_state("dora", lambda state: state.log_rows_lost > 0).log_rows_lost
            self.assertEqual(send("dora", "alice").status, 1)
            wait_for_state("dora", lambda state: state.log_rows_lost > lost)
            state = wait_for_state("dora", lambda state: state.log_rows_lost > 0 and state.frames_not_captured > 0)
            self.assertGreater(state.frames_not_captured, 10)
            parts = diagnostics("dora", lambda parts: parts["files"].level == DiagnosticStatus.WARN)
            self.assertIn("disk", parts["files"].message)
            self.assertIsNone(node.poll())
            self.assertEqual(words.read_text().count("Rows of the logs"), 1)
        finally:
            node.terminate()
            node.wait(timeout=20)


def captured_frames(path):
    """(seconds, octets) of each whole record of a pcap file with nanoseconds."""
    octets = path.read_bytes()
    magic, major, minor, _, _, _, link_type = struct.unpack_from("=IHHiIII", octets)
    assert (magic, major, minor, link_type) == (0xA1B23C4D, 2, 4, 1)
    frames, at = [], 24
    while at + 16 <= len(octets):
        seconds, nanoseconds, size, _ = struct.unpack_from("=IIII", octets, at)
        if at + 16 + size > len(octets):
            break  # being written
        frames.append((seconds + 1e-9 * nanoseconds, octets[at + 16 : at + 16 + size]))
        at += 16 + size
    return frames


class Capture(unittest.TestCase):
    def test_frames_of_both_directions_are_written(self):
        path = Path(rospy.get_param("~folder") + ".pcap")
        addresses = {name: wait_for_state(name, lambda state: True).address for name in ("alice", "bob")}
        octets_of = {name: bytes.fromhex(address.replace(":", "")) for name, address in addresses.items()}
        send("alice", "bob")
        deadline = time.monotonic() + PATIENCE
        seen = set()
        while not {("alice", BEACON), ("bob", BEACON), ("alice", DATA)} <= seen and time.monotonic() < deadline:
            for at, frame in captured_frames(path):
                self.assertEqual(int.from_bytes(frame[12:14], "big"), ETHERTYPE)
                self.assertLess(abs(at - time.time()), 600)
                sender = next((name for name, octets in octets_of.items() if octets == frame[6:12]), None)
                seen.add((sender, frame[15]))
        self.assertIn(("alice", BEACON), seen)
        self.assertIn(("bob", BEACON), seen)
        self.assertIn(("alice", DATA), seen)


class Top(unittest.TestCase):
    def run_top(self, *arguments, **environment):
        command = ["rosrun", "adhoc_communication", "adhoc_top", *arguments]
        return subprocess.run(
            command, capture_output=True, text=True, timeout=60, env={**os.environ, **environment}, check=False
        )

    def test_once_prints_every_robot_of_the_master(self):
        result = self.run_top("--once")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("alice on hub:", result.stdout)
        self.assertIn("bob on hub:", result.stdout)
        self.assertIn("OPEN", result.stdout)
        for word in ("neighbour", "destination", "mc_alice", "relayed topic", "/alice/plan"):
            self.assertIn(word, result.stdout)

    def test_frames_by_type_and_what_the_socket_dropped(self):
        """Neither was shown."""
        before, now = (NetworkState(frames_sent_by_type=[0] * 15, frames_received_by_type=[0] * 15) for _ in range(2))
        now.stamp.secs, now.frames_missed = 2, 7
        now.frames_sent_by_type[BEACON], now.frames_received_by_type[DATA] = 4, 10
        text = top.plain([top.section(time.monotonic(), now, before)])
        self.assertIn("  7 frames missed while the interface's queue was full\n", text)
        lines = [line.split() for line in text.splitlines()]
        self.assertIn(["beacon", "4", "2.0/s", "0", "0.0/s"], lines)
        self.assertIn(["data", "0", "0.0/s", "10", "5.0/s"], lines)
        self.assertNotIn("flood", text)

    def test_live_view_goes_on(self):
        """Plain lines where there is no terminal, one view after the other."""
        command = ["rosrun", "adhoc_communication", "adhoc_top", "--interval", "0.1"]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        try:
            views = 0
            while views < 3:
                line = process.stdout.readline()
                self.assertTrue(line, "adhoc_top has ended")
                views += line.startswith("alice on hub:")
        finally:
            process.terminate()
            process.wait(timeout=20)
            process.stdout.close()

    def test_view_of_a_terminal(self):
        """The tables of rich hold the same facts as the plain lines."""
        try:
            import rich.console
        except ImportError:
            self.skipTest("rich is not installed")
        view = top.View(["/alice/adhoc_communication/network_state"])
        self.assertTrue(top.wait_for_states(view, PATIENCE))
        console = rich.console.Console(width=200, record=True, file=io.StringIO())
        console.print(top.rich_view(view.sections()))
        text = console.export_text()
        for word in ("alice on hub:", "neighbour", "bob", "destination", "mc_alice", "relayed topic"):
            self.assertIn(word, text)

    def test_one_topic(self):
        result = self.run_top("--once", "/bob/adhoc_communication/network_state")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertNotIn("alice on", result.stdout)

    def test_nothing_to_show_is_said(self):
        result = self.run_top("--once", "/nobody/network_state")
        self.assertEqual(result.returncode, 1)
        self.assertIn("no node publishes adhoc_communication/NetworkState on /nobody/network_state", result.stderr)
        result = self.run_top("--once", ROS_MASTER_URI="http://localhost:9")
        self.assertEqual(result.returncode, 1)
        self.assertIn("no ROS master answers at http://localhost:9", result.stderr)


if __name__ == "__main__":
    rostest.rosrun("adhoc_communication", "watching", "__main__")
