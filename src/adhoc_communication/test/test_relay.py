#!/usr/bin/env python3
"""Topics of any type carried from robot to robot."""

import subprocess
import threading
import time
import unittest

import rospy
import rostest
from adhoc_communication import srv
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from geometry_msgs.msg import Point, PointStamped
from namespaces import die_with_parent, program
from std_msgs.msg import String

PATIENCE = 20.0  # s
PACKETS_KEPT_BY_ROOT = 256


class Listener:
    """Collects what is published on a topic."""

    def __init__(self, topic, message_class):
        self.messages = []
        self._arrived = threading.Condition()
        self._subscriber = rospy.Subscriber(topic, message_class, self._store)

    def _store(self, message):
        with self._arrived:
            self.messages.append(message)
            self._arrived.notify_all()

    def wait_for(self, condition):
        with self._arrived:
            assert self._arrived.wait_for(lambda: condition(self.messages), PATIENCE), self.messages
            return list(self.messages)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._subscriber.unregister()


def publisher(topic, message_class, subscribers=1):
    """A publisher with the relaying node connected, and others."""
    result = rospy.Publisher(topic, message_class, queue_size=100)
    wait_until(lambda: result.get_num_connections() >= subscribers, f"the relay subscribes to {topic}")
    return result


def fill_what_alice_keeps(everybody):
    """The packet with the definition is not among those that newcomers to her group get any more."""
    with Listener("/bob/everybody_of_alice", PointStamped) as listener:
        wait_until(lambda: everybody.publish(PointStamped()) or listener.messages, "the listener is connected")
        for count in range(1, PACKETS_KEPT_BY_ROOT + 3):
            everybody.publish(PointStamped())
            listener.wait_for(lambda messages, count=count: len(messages) >= count)


def wait_until(condition, what):
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, f"not within {PATIENCE} s: {what}"
        time.sleep(0.02)


def relay(robot, **fields):
    name = f"/{robot}/adhoc_communication/relay"
    rospy.wait_for_service(name, timeout=PATIENCE)
    return rospy.ServiceProxy(name, srv.Relay)(**fields).relays


def relay_of(robot, topic, destination):
    return next(item for item in relay(robot) if (item.topic, item.destination) == (topic, destination))


def members(robot):
    state = rospy.ServiceProxy(f"/{robot}/adhoc_communication/get_group_state", srv.GetGroupState)
    return set(state(f"mc_{robot}").downlinks)


class Carol:
    """A third robot, started and ended by a test."""

    def __init__(self, **parameters):
        arguments = [f"_{name}:={value}" for name, value in parameters.items()]
        interface = "_interface:=hub:" + rospy.get_param("~hub")
        name = ["__ns:=/carol", "__name:=adhoc_communication", "_robot_name:=carol"]
        command = [program("adhoc_communication"), *name, interface, *arguments]
        self._process = subprocess.Popen(command, preexec_fn=die_with_parent)

    def __enter__(self):
        wait_until(lambda: "carol" in members("alice"), "carol joins the group of alice")
        return self

    def __exit__(self, *_):
        self._process.terminate()
        self._process.wait(timeout=20)


def setUpModule():
    rospy.init_node("test_relay")
    for robot in ("alice", "bob"):
        rospy.wait_for_service(f"/{robot}/adhoc_communication/get_neighbors", timeout=PATIENCE)
    wait_until(lambda: "bob" in members("alice"), "bob joins the group of alice")


class Parameter(unittest.TestCase):
    def test_messages_arrive_whole_in_order_and_with_their_definition(self):
        with Listener("/bob/chatter", DiagnosticStatus) as listener:
            chatter = publisher("/alice/chatter", DiagnosticStatus)
            sent = [DiagnosticStatus(name=f"n{i}", values=[KeyValue("key", "ü" * i)]) for i in range(10)]
            for message in sent:
                chatter.publish(message)
            received = listener.wait_for(lambda messages: len(messages) >= 10)
        self.assertEqual(received, sent)
        header = received[0]._connection_header
        self.assertEqual(header["type"], "diagnostic_msgs/DiagnosticStatus")
        self.assertEqual(header["md5sum"], DiagnosticStatus._md5sum)
        self.assertEqual(header["message_definition"].strip(), DiagnosticStatus._full_text.strip())
        report = relay_of("alice", "/alice/chatter", "bob")
        self.assertEqual((report.delivered, report.dropped, report.failed), (10, 0, 0))
        self.assertEqual(report.type, "diagnostic_msgs/DiagnosticStatus")

    def test_what_came_from_a_robot_does_not_go_back(self):
        """alice carries /alice/shared to /bob/shared, and bob the other way round."""
        with Listener("/alice/shared", String) as at_alice, Listener("/bob/shared", String) as at_bob:
            shared = publisher("/alice/shared", String, subscribers=2)
            shared.publish("once")
            at_bob.wait_for(lambda messages: len(messages) >= 1)
            answer = publisher("/bob/shared", String, subscribers=2)
            answer.publish("back")  # behind anything that bob would have sent back
            at_alice.wait_for(lambda messages: String("back") in messages)
            self.assertEqual(at_alice.messages, [String("once"), String("back")])
            self.assertEqual(at_bob.messages, [String("once"), String("back")])
        self.assertEqual(relay_of("alice", "/alice/shared", "bob").delivered, 1)
        self.assertEqual(relay_of("bob", "/bob/shared", "alice").delivered, 1)


class NewRobot(unittest.TestCase):
    def test_definition_that_a_newcomer_lacks_is_asked_for(self):
        """The packet with the definition is older than what the root of a group keeps for newcomers.

        What is kept may come before carol is known as a member: who subscribes only then misses what comes meanwhile.
        """
        everybody = publisher("/alice/everybody", PointStamped)
        fill_what_alice_keeps(everybody)
        with Listener("/carol/everybody_of_alice", PointStamped) as at_carol, Carol():
            # Again until the subscriber is connected, which takes longer than the node waits where others keep it busy.
            wait_until(lambda: everybody.publish(PointStamped()) or at_carol.messages, "carol knows the definition")

    def test_latched_message_and_definition_go_to_a_robot_that_restarts(self):
        relay("alice", action=srv.RelayRequest.ADD, topic="/alice/target", destination="carol", latched=True,
              remote_topic="/carol/target")  # fmt: skip
        target = publisher("/alice/target", PointStamped)
        target.publish(PointStamped())
        for _ in range(2):
            with Listener("/carol/target", PointStamped) as listener, Carol():
                listener.wait_for(lambda messages: len(messages) >= 1)
        relay("alice", action=srv.RelayRequest.REMOVE, topic="/alice/target", destination="carol")

    def test_latched_message_for_the_group_of_another_reaches_who_joins_late(self):
        """Only alice knows that carol has joined; she tells bob, again if she does not learn in time that he knows."""
        relay("bob", action=srv.RelayRequest.ADD, topic="/bob/found", destination="mc_alice", latched=True,
              remote_topic="found_by_bob")  # fmt: skip
        with Listener("/alice/found_by_bob", PointStamped) as at_alice:
            found = publisher("/bob/found", PointStamped)
            for x in (1.0, 2.0):
                found.publish(PointStamped(point=Point(x=x)))
            at_alice.wait_for(lambda messages: messages and messages[-1].point.x == 2.0)
        fill_what_alice_keeps(publisher("/alice/everybody", PointStamped))
        with Listener("/carol/found_by_bob", PointStamped) as at_carol, Carol():
            at_carol.wait_for(lambda messages: messages and messages[-1].point.x == 2.0)
            self.assertEqual({m.point.x for m in at_carol.messages}, {2.0}, "the newest alone")
        relay("bob", action=srv.RelayRequest.REMOVE, topic="/bob/found", destination="mc_alice")


class Service(unittest.TestCase):
    def test_relay_comes_and_goes_at_run_time(self):
        fields = {"topic": "/alice/late", "destination": "bob", "remote_topic": "/bob/late"}
        relays = relay("alice", action=srv.RelayRequest.ADD, priority="position", rate=50.0, **fields)
        added = relays[-1]
        self.assertEqual((added.topic, added.priority, added.rate), ("/alice/late", "position", 50.0))
        late = publisher("/alice/late", String)
        with Listener("/bob/late", String) as listener:
            late.publish("now")
            listener.wait_for(lambda messages: len(messages) == 1)
        relays = relay("alice", action=srv.RelayRequest.REMOVE, topic="/alice/late", destination="bob")
        self.assertNotIn("/alice/late", [item.topic for item in relays])
        wait_until(lambda: late.get_num_connections() == 0, "the node unsubscribes")

    def test_refusals_are_sentences(self):
        cases = [
            ({"action": 1, "topic": "/x", "destination": "alice"}, "goes to this robot itself"),
            (
                {"action": 1, "topic": "not a topic", "destination": "bob"},
                "relay of 'not a topic' to 'bob' has a wrong name: topic 'not a",
            ),
            (
                {"action": 1, "topic": "/x", "destination": "bob", "priority": "urgent"},
                "relay of '/x' to 'bob' has the priority 'urgent'",
            ),
            ({"action": 1, "topic": "/x", "destination": "bob", "rate": -1.0}, "rate outside"),
            ({"action": 2, "topic": "/x", "destination": "bob"}, "no relay of '/x' to 'bob' exists"),
            ({"action": 9}, "action 9 is none of"),
        ]
        for fields, expected in cases:
            with self.subTest(expected), self.assertRaisesRegex(rospy.ServiceException, expected):
                relay("alice", **fields)

    def test_destination_that_is_away_blocks_nothing_and_is_counted(self):
        relay("alice", action=srv.RelayRequest.ADD, topic="/alice/away", destination="nobody")
        away = publisher("/alice/away", String)
        for number in range(50):
            away.publish(str(number))
        wait_until(lambda: relay_of("alice", "/alice/away", "nobody").dropped == 50, "all are dropped")
        relay("alice", action=srv.RelayRequest.REMOVE, topic="/alice/away", destination="nobody")


if __name__ == "__main__":
    rostest.rosrun("adhoc_communication", "relay", "__main__")
