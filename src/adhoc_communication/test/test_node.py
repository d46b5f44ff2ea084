#!/usr/bin/env python3
"""The node's interface on a master: services, texts of failures, injected topics, parameters, launch files."""

import contextlib
import io
import os
import queue
import random
import re
import signal
import subprocess
import tempfile
import threading
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import rosgraph
import roslib.message
import rospy
import rosservice
import rostest
from adhoc_communication import msg, srv
from geometry_msgs.msg import Quaternion, Twist
from namespaces import program
from nav_msgs.msg import OccupancyGrid
from std_msgs.msg import Float64MultiArray, String

PACKAGE = Path(__file__).resolve().parents[1]
MESSAGE = "dst_robot: bob, topic: topic, type: std_msgs/UInt8, md5sum: 7c8164229e7d2c17eb95e9231617fdee, data: [1]"
LIFETIME = "{{" + MESSAGE + ", lifetime: {}}}"
SERVICES = {
    "send_string": "SendString",
    "send_map": "SendOccupancyGrid",
    "send_position": "SendMmRobotPosition",
    "send_point": "SendMmPoint",
    "send_map_update": "SendMmMapUpdate",
    "send_control_message": "SendMmControl",
    "send_frontier": "SendExpFrontier",
    "send_cluster": "SendExpCluster",
    "send_auction": "SendExpAuction",
    "send_twist": "SendTwist",
    "send_quaternion": "SendQuaternion",
    "send_robot_update": "SendCMgrRobotUpdate",
    "send_message": "SendMessage",
    "broadcast_string": "BroadcastString",
    "broadcast_robot_update": "BroadcastCMgrRobotUpdate",
    "join_mc_group": "ChangeMCMembership",
    "get_group_state": "GetGroupState",
    "get_neighbors": "GetNeighbors",
    "shut_down": "ShutDown",
}


class Listener:
    """Collects what is published on a topic."""

    def __init__(self, topic, message_class):
        self._messages = []
        self._arrived = threading.Condition()
        self._subscriber = rospy.Subscriber(topic, message_class, self._store)

    def _store(self, message):
        with self._arrived:
            self._messages.append(message)
            self._arrived.notify_all()

    def wait_for(self, count=1, timeout=20.0):
        with self._arrived:
            assert self._arrived.wait_for(lambda: len(self._messages) >= count, timeout), self._messages
            return list(self._messages)

    def wait_for_text(self, text, timeout=20.0):
        with self._arrived:
            found = self._arrived.wait_for(lambda: text in [message.data for message in self._messages], timeout)
            assert found, self._messages

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._subscriber.unregister()


def call(robot, service, **fields):
    name = f"/{robot}/adhoc_communication/{service}"
    rospy.wait_for_service(name, timeout=20)
    return rospy.ServiceProxy(name, getattr(srv, SERVICES[service]))(**fields)


def state_of(robot):
    """What a robot says of itself, once a second."""
    return rospy.wait_for_message(f"/{robot}/adhoc_communication/network_state", msg.NetworkState, 20)


def wait_for_state(robot, condition):
    """Until what a robot says of itself fulfils the condition."""
    deadline = time.monotonic() + 20
    while not condition(state_of(robot)):
        assert time.monotonic() < deadline, robot
        time.sleep(0.1)  # the message is latched


@contextlib.contextmanager
def own_node(name, timings, **parameters):
    """A further robot with these timings, its process; at the end, the others have noticed that it is gone."""
    rospy.set_param(f"/{name}/adhoc_communication", {"timings": timings, **parameters})
    command = [program("adhoc_communication"), f"__ns:={name}", f"_robot_name:={name}"]
    node = subprocess.Popen([*command, f"_interface:=hub:{rospy.get_param('~hub')}"], stdout=subprocess.DEVNULL)
    try:
        yield node
    finally:
        node.terminate()
        node.wait(timeout=20)
    deadline = time.monotonic() + 20
    while name in call("alice", "get_neighbors").neigbors:
        assert time.monotonic() < deadline, f"{name} is still a neighbour"
        time.sleep(0.1)


def filled(message_class):
    """A message in which every field differs from its default."""
    message = message_class()
    for index, name in enumerate(message.__slots__):
        setattr(message, name, value_of(message._slot_types[index], index + 1))
    return message


def value_of(kind, seed):
    if kind.endswith("[]"):
        return [value_of(kind[:-2], seed), value_of(kind[:-2], seed + 1)]
    if kind == "string":
        return f"text {seed}"
    if kind == "bool":
        return True
    if kind == "time":
        return rospy.Time(seed, 5)
    if "/" in kind or kind == "Header":
        return filled(roslib.message.get_message_class(kind))
    return float(seed) if kind.startswith("float") else seed


def serialized(message):
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def setUpModule():
    rospy.init_node("test_node")
    for robot in ("alice", "bob", "carol"):
        rospy.wait_for_service(f"/{robot}/adhoc_communication/get_neighbors", timeout=30)
    everybody = {"alice", "bob", "carol"}
    deadline = time.monotonic() + 20
    while any(set(call(robot, "get_neighbors").neigbors) != everybody - {robot} for robot in everybody):
        assert time.monotonic() < deadline, "the robots do not find each other"
        time.sleep(0.05)


class Interface(unittest.TestCase):
    def test_every_service_has_its_contracted_type(self):
        for name, service_type in SERVICES.items():
            found = rosservice.get_service_type(f"/alice/adhoc_communication/{name}")
            self.assertEqual(found, f"adhoc_communication/{service_type}", name)

    def test_topics_of_the_node(self):
        expected = {
            "/alice/adhoc_communication/new_robot": "std_msgs/String",
            "/alice/adhoc_communication/remove_robot": "std_msgs/String",
            "/alice/adhoc_communication/status": "adhoc_communication/Status",
            "/carol/adhoc_communication/arrived": "std_msgs/String",
            "/carol/adhoc_communication/gone": "std_msgs/String",
        }
        published = dict(map(tuple, rospy.get_published_topics()))
        for topic, message_type in expected.items():
            self.assertEqual(published.get(topic), message_type, topic)

    def test_late_subscriber_of_new_robot_learns_all_robots(self):
        with Listener("/alice/adhoc_communication/new_robot", String) as listener:
            messages = listener.wait_for(2)
        self.assertEqual({message.data for message in messages}, {"bob", "carol"})
        self.assertEqual(messages[0]._connection_header["latching"], "1")

    def test_status_is_latched_and_counts(self):
        with Listener("/alice/adhoc_communication/status", msg.Status) as listener:
            first, second = listener.wait_for(2)[:2]
        self.assertEqual(set(second.neighbors), {"bob", "carol"})
        self.assertEqual(set(second.robots), {"bob", "carol"})
        self.assertGreater(second.frames_sent, 0)
        self.assertGreaterEqual(second.frames_received, first.frames_received)
        self.assertEqual(first._connection_header["latching"], "1")

    def test_groups(self):
        own = call("alice", "get_group_state", group_name="mc_alice")
        self.assertTrue(own.member and own.root and own.activated and own.connected)
        unknown = call("alice", "get_group_state", group_name="mc_nobody")
        self.assertEqual((unknown.member, unknown.route_uplink), (False, "No mc entry found!"))
        self.assertEqual(call("alice", "join_mc_group", group_name="mc_bob", action=1).status, 1)
        self.assertTrue(call("alice", "get_group_state", group_name="mc_bob").member)
        self.assertEqual(call("alice", "join_mc_group", group_name="mc_bob", action=0).status, 1)
        self.assertFalse(call("alice", "get_group_state", group_name="mc_bob").member)
        self.assertEqual(call("alice", "join_mc_group", group_name="mc_bob", action=1).status, 1)


class Delivery(unittest.TestCase):
    def check_transfer(self, service, field, message, destination="bob"):
        topic = f"transfer/{service}"
        with Listener(f"/bob/{topic}", type(message)) as listener:
            self.assertEqual(call("alice", service, dst_robot=destination, topic=topic, **{field: message}).status, 1)
            received = listener.wait_for()[0]
        if hasattr(message, "src_robot"):
            self.assertEqual(received.src_robot, "alice")
            message.src_robot = "alice"
        self.assertEqual(received, message)
        # Who comes late must not drive on an old command.
        self.assertEqual(received._connection_header["latching"], "0" if isinstance(message, Twist) else "1")

    def test_every_message_type_arrives_whole_with_its_true_sender(self):
        cases = [
            ("send_map", "map", OccupancyGrid),
            ("send_position", "position", msg.MmRobotPosition),
            ("send_point", "point", msg.MmPoint),
            ("send_map_update", "map_update", msg.MmMapUpdate),
            ("send_control_message", "msg", msg.MmControl),
            ("send_frontier", "frontier", msg.ExpFrontier),
            ("send_cluster", "cluster", msg.ExpCluster),
            ("send_auction", "auction", msg.ExpAuction),
            ("send_twist", "twist", Twist),
            ("send_quaternion", "quaternion", Quaternion),
            ("send_robot_update", "update", msg.CMgrRobotUpdate),
        ]
        for service, field, message_class in cases:
            with self.subTest(service):
                self.check_transfer(service, field, filled(message_class))

    def test_group_reaches_its_members(self):
        self.check_transfer("send_frontier", "frontier", filled(msg.ExpFrontier), destination="mc_alice")

    def test_empty_destination_is_a_broadcast_to_the_neighbours(self):
        at_bob, at_carol = (Listener(f"/{robot}/hello_all", msg.RecvString) for robot in ("bob", "carol"))
        with at_bob, at_carol:
            call("alice", "send_string", dst_robot="", topic="hello_all", data="hello")
            for listener in (at_bob, at_carol):
                message = listener.wait_for()[0]
                self.assertEqual((message.src_robot, message.data), ("alice", "hello"))

    def test_flooded_broadcasts(self):
        with Listener("/carol/flood", msg.RecvString) as listener:
            self.assertEqual(call("bob", "broadcast_string", topic="flood", data="wide", hop_limit=3).status, 1)
            self.assertEqual(listener.wait_for()[0].src_robot, "bob")
        update = filled(msg.CMgrRobotUpdate)
        with Listener("/carol/flood_update", msg.CMgrRobotUpdate) as listener:
            call("bob", "broadcast_robot_update", topic="flood_update", update=update, hop_limit=1)
            self.assertEqual(listener.wait_for()[0], update)

    def test_absolute_topic_is_used_as_given(self):
        with Listener("/anywhere/else", msg.RecvString) as listener:
            call("alice", "send_string", dst_robot="bob", topic="/anywhere/else", data="x")
            self.assertEqual(listener.wait_for()[0].data, "x")

    def test_waiting_subscriber_gets_the_first_messages_of_a_new_topic(self):
        texts = [str(number) for number in range(20)]
        with Listener("/bob/new_topic", msg.RecvString) as listener:
            for text in texts:
                call("alice", "send_string", dst_robot="bob", topic="new_topic", data=text)
            self.assertEqual([message.data for message in listener.wait_for(len(texts))], texts)

    def test_late_subscriber_gets_the_last_message(self):
        with Listener("/bob/late", msg.RecvString) as early:
            for data in ("first", "last"):
                call("alice", "send_string", dst_robot="bob", topic="late", data=data)
            early.wait_for_text("last")
        with Listener("/bob/late", msg.RecvString) as listener:
            self.assertEqual(listener.wait_for()[0].data, "last")

    def test_message_of_any_type(self):
        sent = Float64MultiArray(data=[1.0, 2.5])
        with Listener("/carol/numbers", Float64MultiArray) as listener:
            call(
                "alice", "send_message", dst_robot="carol", topic="numbers", type=sent._type, md5sum=sent._md5sum,
                definition=sent._full_text, data=serialized(sent),
            )  # fmt: skip
            self.assertEqual(listener.wait_for()[0].data, (1.0, 2.5))

    def test_topic_that_changes_its_type_is_dropped_and_the_node_lives(self):
        with Listener("/bob/fixed", msg.RecvString) as listener:
            call("alice", "send_string", dst_robot="bob", topic="fixed", data="one")
            listener.wait_for()  # connected now
            call("alice", "send_twist", dst_robot="bob", topic="fixed", twist=Twist())
            call("alice", "send_string", dst_robot="bob", topic="fixed", data="two")
            self.assertEqual([message.data for message in listener.wait_for(2)], ["one", "two"])

    def test_a_subscriber_that_never_connects_holds_up_no_other_topic(self):
        gone = rosgraph.Master("/gone")
        with Listener("/bob/prompt", msg.RecvString) as listener:
            call("alice", "send_string", dst_robot="bob", topic="prompt", data="first")
            listener.wait_for()
            for number in range(5):
                gone.registerSubscriber(f"/bob/held_{number}", "adhoc_communication/RecvString", "http://127.0.0.1:1")
                call("alice", "send_string", dst_robot="bob", topic=f"held_{number}", data="x")
            begin = time.monotonic()
            call("alice", "send_string", dst_robot="bob", topic="prompt", data="second")
            listener.wait_for(2)
            self.assertLess(time.monotonic() - begin, 1.0)

    def test_a_subscriber_that_hangs_loses_the_oldest_and_holds_up_no_other(self):
        echo = ["rostopic", "echo", "/bob/heavy/src_robot"]
        hung = subprocess.Popen(echo, stdout=subprocess.PIPE, env={**os.environ, "PYTHONUNBUFFERED": "1"})
        try:
            with Listener("/bob/heavy", msg.RecvString) as listener:
                call("alice", "send_string", dst_robot="bob", topic="heavy", data="first")
                listener.wait_for()
                self.assertTrue(hung.stdout.readline())
                hung.send_signal(signal.SIGSTOP)
                before = state_of("bob").packets_not_published
                texts = [f"{number} " + random.Random(number).randbytes(1_000_000).hex() for number in range(20)]
                for text in texts:
                    call("alice", "send_string", dst_robot="bob", topic="heavy", data=text)
                got = listener.wait_for(1 + len(texts))
                self.assertEqual([message.data for message in got[1:]], texts)
            wait_for_state("bob", lambda state: state.packets_not_published > before)
        finally:
            hung.kill()
            hung.wait()
            hung.stdout.close()

    def test_own_log_has_a_row_per_call(self):
        call("alice", "send_string", dst_robot="bob", topic="logged", data="12345")
        log = Path(rospy.get_param("~log_path")) / "adhoc_communication" / "alice" / "services.csv"
        lines = log.read_text().splitlines()
        self.assertEqual(lines[0], "#time,service,time_call,time_res,data_size,return")
        self.assertTrue(any(line.split(",")[1] == "send_string" and line.endswith(",5,1") for line in lines[1:]))

    def test_logs_are_those_of_the_table_with_its_columns(self):
        call("alice", "send_string", dst_robot="bob", topic="logged", data="12345")
        logs = Path(rospy.get_param("~log_path")) / "adhoc_communication" / "alice"
        written = {log.name: log.read_text().split("\n", 1)[0].lstrip("#").split(",") for log in logs.glob("*.csv")}
        self.assertEqual(written, documented_logs())


class Failures(unittest.TestCase):
    def called(self, service, arguments):
        command = ["rosservice", "call", f"/alice/adhoc_communication/{service}", *arguments]
        return subprocess.run(command, capture_output=True, text=True, timeout=60)

    def assert_failed(self, result, *expected):
        output = result.stdout + result.stderr
        self.assertNotEqual(result.returncode, 0, output)
        for text in expected:
            self.assertIn(text, output)
        self.assertNotIn("Traceback", output)

    def test_texts_reach_the_shell(self):
        cases = [
            ("send_string", ["alice", "topic", "hello"], ["alice"]),
            ("send_string", ["bob", "", "hello"], ["topic"]),
            ("send_string", ["bob", "not a topic", "hello"], ["'not a topic'", "not a valid topic name"]),
            ("send_string", ["bob", "topic", ""], ["data is empty"]),
            ("send_string", ["dave", "topic", "hello"], ["dave"]),
            ("send_twist", ["alice", "topic", "{}"], ["alice"]),
            ("send_message", ["{dst_robot: bob, topic: topic, type: Twist}"], ["'Twist'", "package/Name"]),
            ("send_message", [LIFETIME.format(-1)], ["lifetime -1", "0 .. 86400"]),
            ("send_message", [LIFETIME.format(".inf")], ["lifetime inf", "0 .. 86400"]),
            ("broadcast_string", ["", "hello", "1"], ["topic"]),
            ("join_mc_group", ["mc_alice", "0"], ["mc_alice"]),
        ]
        with ThreadPoolExecutor(4) as pool:  # a shell command takes a second to start, and mostly waits
            results = list(pool.map(lambda case: self.called(*case[:2]), cases))
        for (service, arguments, expected), result in zip(cases, results):
            with self.subTest(service=service, arguments=arguments):
                self.assert_failed(result, *expected)

    def test_packet_that_is_too_large(self):
        big = OccupancyGrid()
        big.data = [0] * 12_000_000
        with self.assertRaisesRegex(rospy.ServiceException, "max_packet_size"):
            call("alice", "send_map", dst_robot="bob", topic="big", map=big)

    def test_many_slow_sends_block_neither_calls_nor_the_end(self):
        failures = []

        def send():
            try:
                call("patient", "send_string", dst_robot="nobody", topic="x", data="x")
            except rospy.ServiceException as error:
                failures.append(str(error))

        with own_node("patient", {"route_request_wait": 2000}) as node:  # 30 s until there is no route
            wait_for_state("patient", lambda state: {"bob", "carol"} <= set(state.robots))
            threads = [threading.Thread(target=send) for _ in range(40)]
            for thread in threads:
                thread.start()
            wait_for_state("patient", lambda state: state.packets_waiting >= 40)
            self.assertLessEqual({"bob", "carol"}, set(call("patient", "get_neighbors").neigbors))
            self.assertEqual(call("patient", "send_string", dst_robot="bob", topic="quick", data="x").status, 1)
            self.assertEqual(failures, [])
            node.terminate()
            self.assertEqual(node.wait(timeout=10), 0)
            for thread in threads:
                thread.join()
        self.assertEqual(len(failures), 40)

    def test_lifetime_and_newest_only_of_single_messages(self):
        sent = String("x")
        kind = {"type": sent._type, "md5sum": sent._md5sum, "definition": sent._full_text, "data": serialized(sent)}
        failures = queue.Queue()

        def send(**terms):
            try:
                call("brief", "send_message", dst_robot="nobody", topic="pose", **kind, **terms)
            except rospy.ServiceException as error:
                failures.put(str(error))

        with own_node("brief", {"route_request_wait": 2000}):  # 30 s until there is no route
            wait_for_state("brief", lambda state: {"bob", "carol"} <= set(state.robots))
            send(lifetime=0.5)
            self.assertIn("within its lifetime of 0.5 s", failures.get(timeout=20))
            threads = [threading.Thread(target=send), threading.Thread(target=send, kwargs={"newest_only": True})]
            for waiting, thread in enumerate(threads, start=1):
                thread.start()
                wait_for_state("brief", lambda state, waiting=waiting: state.packets_waiting >= waiting)
            send_newer = threading.Thread(target=send, kwargs={"newest_only": True})
            send_newer.start()
            self.assertIn("a newer packet for topic 'pose' has taken its place", failures.get(timeout=20))
            self.assertTrue(failures.empty(), "the others go on")
        for thread in [*threads, send_newer]:
            thread.join()

    def test_lifetime_and_newest_only_as_parameters(self):
        failures = queue.Queue()

        def send(topic):
            try:
                call("terse", "send_string", dst_robot="nobody", topic=topic, data="x")
            except rospy.ServiceException as error:
                failures.put(str(error))

        with own_node("terse", {"route_request_wait": 2000}, send_lifetime=3.0, newest_only="/pose"):
            wait_for_state("terse", lambda state: {"bob", "carol"} <= set(state.robots))
            send("other")
            self.assertIn("within its lifetime of 3 s", failures.get(timeout=20))
            threads = [threading.Thread(target=send, args=(topic,)) for topic in ("pose", "pose", "other", "other")]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            ends = sorted(failures.get_nowait().split(": ")[-1] for _ in threads)
            self.assertIn("a newer packet for topic 'pose' has taken its place", ends[0])
            self.assertIn("within its lifetime of 3 s", ends[1])
            self.assertEqual(ends[1:], 3 * [ends[1]], "of the others each goes on")

    def test_start_is_refused_with_one_sentence(self):
        hub = "hub:" + rospy.get_param("~hub")
        cases = [
            (["_interface:=nowhere0"], "interface 'nowhere0' does not exist (existing: "),
            (["_interface:=hub:/nowhere/hub"], "no radio answers at hub socket '/nowhere/hub'"),
            ([f"_interface:={hub}", "_beacon_interval:=-5"], "beacon_interval"),
            ([f"_interface:={hub}", "_max_frame_size:=3"], "max_frame_size"),
            ([f"_interface:={hub}", "_timings:=slow"], "has the preset 'slow', not robots or rfc3561"),
            ([f"_interface:={hub}", "_loss_ratio:=1.5"], "loss_ratio"),
            ([f"_interface:={hub}", "_num_rreq:=many"], "parameter ~num_rreq = many is not an integer"),
            ([f"_interface:={hub}", "_mac:=xx"], "parameter ~mac = xx 'xx' is not a hardware address"),
            ([f"_interface:={hub}", "_simulation_mode:=true", "_robot_name:=bob"], "must be robot_<integer>"),
            ([f"_interface:={hub}", "_log_path:=/proc"], "log_path"),
        ]
        for number, (arguments, expected) in enumerate(cases):
            with self.subTest(arguments=arguments):
                name = f"refused_{number}"
                command = [program("adhoc_communication"), f"__name:={name}", *arguments]
                result = subprocess.run(command, capture_output=True, text=True, timeout=30)
                output = result.stdout + result.stderr
                self.assertEqual(result.returncode, 1, output)
                self.assertEqual(output.count("FATAL"), 1, output)
                self.assertIn(expected, output)

    def test_timings_that_differ_from_their_preset(self):
        with own_node("hasty", {"route_request_wait": 20, "request_retries": 1}):
            with self.assertRaises(rospy.ServiceException) as raised:
                call("hasty", "send_string", dst_robot="nobody", topic="t", data="x")
            self.assertIn("no route to nobody after 0.1 s", str(raised.exception))


class Help(unittest.TestCase):
    def test_the_node_explains_itself_without_a_master(self):
        """It waited for one, for ever."""
        for word in ("--help", "-h"):
            done = subprocess.run(
                [program("adhoc_communication"), word],
                env={**os.environ, "ROS_MASTER_URI": "http://localhost:1"},
                capture_output=True, text=True, timeout=30.0, check=True,
            )  # fmt: skip
            self.assertTrue(done.stdout.startswith("usage: rosrun adhoc_communication adhoc_communication "))
            self.assertIn("\nParameters: ", done.stdout)
            self.assertEqual(done.stderr, "")


class Documentation(unittest.TestCase):
    def test_parameter_table_of_the_readme(self):
        command = [program("adhoc_communication"), "--list-parameters"]
        listed = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
        expected = [tuple(line.split("\t")[:3]) for line in listed]
        self.assertEqual(sorted(table_of_parameters()), sorted(expected))

    def test_option_table_of_the_radio(self):
        """Each option of the help that has a default stands in the table of the README with the same one."""
        command = [program("radio"), "--help"]
        listed = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
        words = [line.split() for line in listed if line.startswith("  --")]
        defaults = {option: default for option, default, *_ in words if not default.isupper()}
        self.assertEqual(table_of_radio_options(), {**defaults, "--walls": "none"})


def documented_logs():
    """File -> columns of the table of docs/logs.md."""
    rows = re.findall(r"^\| `(\w+\.csv)` \| [^|]* \| ([^|]*) \|", (PACKAGE / "docs" / "logs.md").read_text(), re.M)
    return {name: re.findall(r"`(\w+)`", columns) for name, columns in rows}


def table_of_parameters():
    """(name, type, default) of every row of the tables below the heading Parameters of README.md."""
    text = (PACKAGE / "README.md").read_text().split("## Parameters", 1)[1].split("\n## ", 1)[0]
    lines = [line for line in text.splitlines() if line.startswith("| `")]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return [(row[0].strip("`"), row[1], row[2].strip("`")) for row in rows]


def table_of_radio_options():
    """Option -> default of the table below the heading The radio daemon of README.md; a row may hold several."""
    text = (PACKAGE / "README.md").read_text().split("## The radio daemon", 1)[1].split("\n## ", 1)[0]
    options = {}
    for row in (line.split("|") for line in text.splitlines() if line.startswith("| `")):
        names = [name.strip(" `") for name in row[1].split(",")]
        defaults = row[2].strip().split(", ")
        assert len(names) == len(defaults), row
        options.update(zip(names, defaults))
    return options


class LaunchFiles(unittest.TestCase):
    """The entry points of the original start the node and pass their arguments on."""

    def start(self, file, *arguments):
        environment = {**os.environ, "ROS_NAMESPACE": "launched"}
        command = ["roslaunch", "adhoc_communication", file, *arguments]
        return subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL)

    def check(self, file, arguments, parameters):
        process = self.start(file, f"interface:=hub:{rospy.get_param('~hub')}", *arguments)
        try:
            rospy.wait_for_service("/launched/adhoc_communication/get_neighbors", timeout=30)
            for name, value in parameters.items():
                self.assertEqual(rospy.get_param(f"/launched/adhoc_communication/{name}"), value, name)
        finally:
            process.terminate()
            process.wait(timeout=20)

    def test_adhoc_communication_launch(self):
        with tempfile.TemporaryDirectory() as folder:
            self.check(
                "adhoc_communication.launch",
                ["robot_name:=dora", "num_of_robots:=3", "nack_threshold:=7", f"log_path:={folder}"],
                {"robot_name": "dora", "robots_in_simulation": 3, "nack_threshold": 7, "log_path": folder},
            )

    def test_adhoc_launch(self):
        self.check("adhoc.launch", ["loss_ratio:=0.1", "p_tx:=10"], {"loss_ratio": 0.1, "p_tx": 10})


class Termination(unittest.TestCase):  # the last by name, because it takes a robot away
    def test_shut_down_ends_the_node_and_the_others_notice(self):
        with Listener("/alice/adhoc_communication/remove_robot", String) as listener:
            call("carol", "shut_down")
            listener.wait_for_text("carol")
        services = rosservice.get_service_list()
        self.assertNotIn("/carol/adhoc_communication/send_string", services)


if __name__ == "__main__":
    rostest.rosrun("adhoc_communication", "node", "__main__")
