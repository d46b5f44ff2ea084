"""Orders to a robot and its answers in virtual time: the same messages over the same radio as between nodes."""

import pytest

pytest.importorskip("explorer.msg")

from explorer.msg import TeamState

from explorer.mission_control import MissionControl
from explorer.ros_team import ORDERS_TOPIC, STATES_TOPIC, order_to, state_from
from mr_experiments.host.mission import Mission
from mr_experiments.trial.trial import Trial


def test_a_control_beside_a_robot_pauses_the_other_one_and_lets_it_go_on():
    mission = Mission(Trial("small8x8", 2, 1, limit=60.0))
    control = MissionControl("robot_0", 1)
    first, other = mission.robots
    take = first.on_packet

    def on_packet(topic, octets, now):
        if topic == STATES_TOPIC:
            control.on_state(state_from(TeamState().deserialize(octets)), now)
        take(topic, octets, now)

    def send(_):
        control.on_robots(["robot_1"], mission.now)
        for robot, order in control.tick(mission.now):
            first.explorer._radio.send_typed(robot, ORDERS_TOPIC, order_to(order), lambda *_: None)

    first.on_packet = on_packet
    mission.run(until=8.0, progress=send)
    (member,) = control.members(mission.now)
    assert member.state is not None and member.state.text.startswith("drives to")
    assert control.order("pause").done
    mission.run(until=10.0, progress=send)
    (member,) = control.members(mission.now)
    assert member.answered and member.state.text == "is paused" and other.explorer.agent.text == "is paused"
    control.order("resume")
    mission.run(until=12.0, progress=send)
    assert other.explorer.agent.text != "is paused" and first.explorer.agent.text != "is paused"
