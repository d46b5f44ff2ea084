"""Messages of any type between two robots in virtual time."""

import genpy
import pytest
from geometry_msgs.msg import PoseWithCovarianceStamped
from std_msgs.msg import String

from mr_experiments.common.stopwatch import Stopwatch
from mr_experiments.host.agenda import Agenda
from mr_experiments.host.fast.perfect_radio import PerfectRadio
from mr_experiments.host.radio import Radio, TypedMessage
from mr_experiments.host.robot_radio import RobotRadio
from mr_experiments.trial.radio_options import RadioOptions

END = 3.0  # s


class Ear:
    def __init__(self):
        self.heard, self.robots = [], []

    def on_packet(self, topic, message, now):
        self.heard.append((topic, message, now))

    def on_robot_appeared(self, robot, now):
        self.robots.append(robot)

    def on_robot_lost(self, robot, now):
        pass


def estimate() -> PoseWithCovarianceStamped:
    message = PoseWithCovarianceStamped()
    message.header.frame_id, message.header.stamp = "alice/map", genpy.Time(7, 5)
    message.pose.pose.position.x, message.pose.pose.orientation.w = 1.25, 1.0
    message.pose.covariance[0] = 0.04
    return message


def team(radio):
    """Two robots in each other's reach: their ends of the radio and what they hear."""
    robots = [(RobotRadio(radio, Stopwatch()), Ear()) for _ in range(2)]
    for (own, ear), name, x in zip(robots, ("alice", "bob"), (0.0, 3.0)):
        own.index = radio.add(name, ear, (x, 0.0))
    return robots


def run(radio, until):
    while radio.advance(until) < until:
        radio.tell(0.0)
    radio.tell(until)


def test_message_of_any_type_arrives_with_topic_and_bytes():
    radio = Radio(RadioOptions(loss=0.1), seed=1)
    (alice, _), (_, ear) = team(radio)
    run(radio, END)
    answers = []
    alice.send_typed("bob", "estimates", estimate(), lambda *answer: answers.append(answer))
    alice.send_typed("bob", "words", String("hello"), lambda *answer: answers.append(answer))
    run(radio, 2.0 * END)
    assert answers == [(True, "")] * 2
    (topic, octets, _), (other_topic, word, _) = sorted(ear.heard)
    assert (topic, other_topic) == ("estimates", "words")
    assert PoseWithCovarianceStamped().deserialize(octets) == estimate()
    assert String().deserialize(word).data == "hello"


def test_message_of_any_type_goes_to_a_group():
    radio = Radio(RadioOptions(), seed=1)
    (alice, _), (_, ear) = team(radio)
    run(radio, END)
    alice.send_typed("mc_alice", "estimates", estimate(), lambda *_: None)
    run(radio, 2.0 * END)
    assert [(topic, PoseWithCovarianceStamped().deserialize(octets)) for topic, octets, _ in ear.heard] == [
        ("estimates", estimate())
    ]


def test_type_that_is_none_is_refused():
    radio = Radio(RadioOptions(), seed=1)
    (alice, _), _ = team(radio)
    with pytest.raises(ValueError, match="package/Name"):
        radio.send_message(alice.index, "bob", "words", TypedMessage("String", "0" * 32, "", b""), lambda *_: None)


def test_radio_that_is_off_sends_nothing():
    radio = Radio(RadioOptions(), seed=1)
    (alice, _), _ = team(radio)
    radio.switch_off(alice.index)
    answers = []
    alice.send_typed("bob", "words", String("hello"), lambda *answer: answers.append(answer))
    assert answers == [(False, "the radio is switched off")]


def test_perfect_radio_delivers_messages_of_any_type():
    agenda = Agenda()
    radio = PerfectRadio(agenda)
    (alice, _), (_, ear) = team(radio)
    alice.send_typed("bob", "estimates", estimate(), lambda *_: None)
    agenda.run_due(1.0)
    (topic, octets, _) = ear.heard[0]
    assert topic == "estimates" and PoseWithCovarianceStamped().deserialize(octets) == estimate()
