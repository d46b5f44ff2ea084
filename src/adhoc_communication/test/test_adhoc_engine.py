"""The engines for hosts in Python: module adhoc_engine."""

from io import BytesIO

import adhoc_engine
import numpy as np
import pytest
from adhoc_communication.msg import MmControl

SECOND = 1_000_000_000


def team_of(count, spacing=8.0, seed=1, **medium):
    options = adhoc_engine.MediumOptions()
    for name, value in medium.items():
        setattr(options, name, value)
    team = adhoc_engine.Team(options, seed)
    team.set_key(bytes(range(32)))
    for i in range(count):
        robot = adhoc_engine.EngineOptions()
        robot.robot_name = f"robot_{i}"
        assert team.add(robot, spacing * i, 0.0) == i
    return team


def run(team, seconds):
    """All events until then, with their times."""
    end = team.now + round(seconds * SECOND)
    events = []
    while team.now < end:
        events += [(team.now, robot, event) for robot, event in team.advance(end)]
    return events


def serialised(message):
    octets = BytesIO()
    message.serialize(octets)
    return octets.getvalue()


def packets(events, robot):
    return [e for _, r, e in events if r == robot and isinstance(e, adhoc_engine.PacketReceived)]


def test_advance_stops_at_the_first_event_and_then_goes_on():
    team = team_of(2)
    events = team.advance(10 * SECOND)
    assert 0 < team.now < SECOND
    assert {type(event) for _, event in events} == {adhoc_engine.RobotAppeared}
    run(team, 1.0)
    assert team.advance(team.now + SECOND // 10) == [] and team.neighbors(0) == ["robot_1"]


def test_a_ros_message_arrives_over_two_hops_with_its_true_sender():
    team = team_of(3, loss=0.1)
    run(team, 2.0)
    assert team.neighbors(0) == ["robot_1"] and sorted(team.robots(0)) == ["robot_1", "robot_2"]
    sent = team.send(0, "send_control_message", "robot_2", "control", serialised(MmControl("forged", [1, 2])))
    events = run(team, 2.0)
    (packet,) = packets(events, 2)
    kind, octets = packet.message()
    assert (packet.source, packet.topic, packet.hops) == ("robot_0", "control", 2)
    assert kind == "adhoc_communication/MmControl"
    assert MmControl().deserialize(octets) == MmControl("robot_0", (1, 2))
    ends = [e for _, r, e in events if r == 0 and isinstance(e, adhoc_engine.SendFinished)]
    assert [(end.id, end.delivered, end.reason) for end in ends] == [(sent, True, "")]
    assert team.statistics(0)["packets_sent"] >= 1


def test_group_of_a_robot_and_a_robot_that_dies():
    team = team_of(3, spacing=3.0)
    run(team, 2.0)
    team.kill(2)
    team.send(0, "send_control_message", "mc_robot_0", "control", serialised(MmControl("", [])))
    events = run(team, 8.0)
    assert len(packets(events, 1)) == 1
    assert [e.robot for _, r, e in events if r == 0 and isinstance(e, adhoc_engine.RobotLost)] == ["robot_2"]
    team.restart(2)
    assert any(isinstance(e, adhoc_engine.RobotAppeared) and e.robot == "robot_2" for _, _, e in run(team, 1.0))


def test_octets_that_are_no_message_are_refused_where_they_arrive():
    team = team_of(2)
    run(team, 1.0)
    team.send(0, "send_control_message", "robot_1", "control", b"\xff\xff\xff\xff")
    (packet,) = packets(run(team, 1.0), 1)
    with pytest.raises(adhoc_engine.PayloadError, match="ends before"):
        packet.message()


def test_walls_cut_the_radio():
    options = adhoc_engine.MediumOptions()
    options.set_walls(np.ones((400, 4), np.uint8), 0.05, (3.9, -10.0))
    options.wall_attenuation = 60.0
    team = adhoc_engine.Team(options, 1)
    for i in range(2):
        robot = adhoc_engine.EngineOptions()
        robot.robot_name = f"robot_{i}"
        team.add(robot, 8.0 * i, 0.0)
    run(team, 3.0)
    assert team.neighbors(0) == []
    team.set_position(1, 1.0, 0.0)
    run(team, 3.0)
    assert team.neighbors(0) == ["robot_1"]


def test_same_seed_same_frames():
    def trace(seed):
        team = team_of(3, seed=seed, loss=0.2)
        run(team, 3.0)
        return team.trace_hash

    assert trace(1) == trace(1) != trace(2)


def test_bad_input_names_the_culprit():
    team = team_of(1)
    with pytest.raises(ValueError, match="send_nothing"):
        team.send(0, "send_nothing", "robot_1", "topic", b"")
    with pytest.raises(ValueError, match="32 octets"):
        team.set_key(b"short")
    with pytest.raises(IndexError):
        team.neighbors(7)
    team.kill(0)
    with pytest.raises(ValueError, match="robot 0 was killed"):
        team.neighbors(0)


def test_a_message_of_any_type_arrives_and_its_type_is_checked():
    team = team_of(2)
    run(team, 2.0)
    team.send_message(0, "robot_1", "level", "std_msgs/UInt8", "7c8164229e7d2c17eb95e9231617fdee", "uint8 data\n", b"*")
    (packet,) = packets(run(team, 1.0), 1)
    assert (packet.topic, packet.message()) == ("level", ("std_msgs/UInt8", b"*"))
    with pytest.raises(adhoc_engine.PayloadError, match="32 hexadecimal digits"):
        team.send_message(0, "robot_1", "level", "std_msgs/UInt8", "none", "", b"*")
