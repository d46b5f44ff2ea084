"""A mission control and robots on virtual time, over a radio that loses what it is told to lose."""

from typing import Callable, Dict, List, Set

import pytest
from test_agent import Bench, corridor

from explorer.limits import Limits
from explorer.messages import SendState
from explorer.mission_control import MOST_ROBOTS, MissionControl, summary_of
from explorer.status import State
from explorer.team_orders import INTEREST, MOST_CONTROLS, PERIOD
from explorer.team_state import ROLL_CALL, TeamOrder, TeamState


class Field:
    """Robots with a map, and a control. `lost(kind, robot)`: a message of that kind ("order", "state") is lost."""

    def __init__(self, *names: str) -> None:
        self.control = MissionControl("base", 1000)
        self.robots: Dict[str, Bench] = {name: Bench(7, name).map(corridor()) for name in names}
        self.reached: Set[str] = set(names)
        self.lost: Callable[[str, str], bool] = lambda kind, robot: False
        self.orders: List[str] = []
        self.states = 0
        self.now = 100.0

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.5)):
            self.now += 0.5
            self.control.on_robots(sorted(self.reached), self.now)
            for robot, order in self.control.tick(self.now):
                if order.order != ROLL_CALL:
                    self.orders.append(f"{robot} {order.order}")
                if robot in self.reached and not self.lost("order", robot):
                    self.robots[robot].agent.on_order(order, self.now)
            for name, bench in self.robots.items():
                self.hear(name, bench.run(0.5, 0.25))

    def hear(self, name: str, effects: list) -> None:
        for effect in effects:
            if isinstance(effect, SendState):
                assert effect.to == "base"
                self.states += 1
                if name in self.reached and not self.lost("state", name):
                    self.control.on_state(effect.state, self.now)

    def told(self) -> List[str]:
        return ["nothing" if member.state is None else member.state.text for member in self.control.members(self.now)]


def test_the_control_knows_how_each_robot_is_and_stops_and_starts_them_all() -> None:
    field = Field("anna", "bob")
    field.run(2.0)
    assert all(text.startswith("drives to") for text in field.told())
    answer = field.control.order("pause")
    assert answer.done and answer.text == "pause: sent to anna, bob"
    field.run(2.0)
    assert field.told() == ["is paused", "is paused"] and all(m.answered for m in field.control.members(field.now))
    assert field.orders == ["anna pause", "bob pause"], "answered orders are not repeated"
    field.control.order("return_now", ["bob"])
    field.run(2.0)
    assert field.told()[0] == "is paused" and field.told()[1].startswith("is called back")
    field.control.order("stop")
    field.run(2.0)
    assert {bench.agent.state for bench in field.robots.values()} == {State.FINISHED}


def test_the_control_starts_robots_that_wait_for_it() -> None:
    field = Field("anna")
    field.robots["anna"].agent = type(field.robots["anna"].agent)(Bench(7, "anna", autostart=False).agent.options)
    field.robots["anna"].map(corridor())
    field.run(2.0)
    assert field.told() == ["waits for the start"]
    field.control.order("start")
    field.run(2.0)
    assert field.told()[0].startswith("drives to")


def test_an_order_that_is_lost_is_sent_again_and_carried_out_once() -> None:
    field = Field("anna")
    losses = ["order", "state", "state"]
    field.lost = lambda kind, robot: kind in losses and losses.remove(kind) is None
    field.run(1.0)
    field.control.order("pause")
    field.run(10.0)
    assert field.robots["anna"].agent.text == "is paused" and len(field.orders) > 1
    (member,) = field.control.members(field.now)
    assert member.answered and member.state is not None and member.state.answer == (True, "paused")


def test_a_robot_out_of_reach_gets_the_last_order_when_it_is_back() -> None:
    field = Field("anna", "bob")
    field.run(2.0)
    field.reached = {"anna"}
    field.run(1.0)
    answer = field.control.order("pause")
    assert answer.text == "pause: sent to anna; bob get it when they are back"
    field.run(10.0)
    field.control.order("stop")
    field.run(5.0)
    assert not any(order.startswith("bob") for order in field.orders)
    assert "bob: exploring" in summary_of(field.control.members(field.now))
    assert "out of reach for" in summary_of(field.control.members(field.now))
    field.reached = {"anna", "bob"}
    field.run(2.0)
    assert field.robots["bob"].agent.text == "stopped" and field.orders[-1] == "bob stop"


def test_limits_are_set_over_the_radio_and_hold_beside_an_order() -> None:
    """A robot that was away gets both: limits take the place of limits, not of an order."""
    field = Field("anna", "bob")
    field.reached = {"anna"}
    field.run(1.0)
    field.control.order("pause")
    field.control.order("set_limits", limits=Limits(1000.0, 0.0))
    assert field.control.order("set_limits", limits=Limits(900.0, 50.0)).text == ("set_limits: sent to anna"), (
        "bob was never heard of"
    )
    field.run(3.0)
    field.reached = {"anna", "bob"}
    field.run(6.0)
    for bench in field.robots.values():
        assert bench.agent.text == "is paused" and bench.agent.mission.orders.limits == Limits(900.0, 50.0)
    assert field.orders.count("bob set_limits") == 1 and all(m.answered for m in field.control.members(field.now))


def test_bad_limits_are_refused_by_the_robot_and_it_says_why() -> None:
    field = Field("anna")
    field.run(1.0)
    before = field.robots["anna"].agent.mission.orders.limits
    field.control.order("set_limits", ["anna"], Limits(-1.0, 0.0))
    field.run(3.0)
    (member,) = field.control.members(field.now)
    assert member.answered and member.state is not None and not member.state.answer.done
    assert "time_limit" in member.state.answer.text
    assert field.robots["anna"].agent.mission.orders.limits == before


def test_a_robot_that_comes_later_gets_what_all_were_ordered() -> None:
    field = Field("anna", "bob")
    field.reached = {"anna"}
    field.run(1.0)
    field.control.order("pause")
    field.run(2.0)
    field.reached = {"anna", "bob"}
    field.run(2.0)
    assert field.told() == ["is paused", "is paused"]


def test_nobody_tells_anything_without_a_control_and_not_for_long_after_it_has_gone() -> None:
    field = Field("anna")
    field.reached = set()
    field.run(20.0)
    assert field.states == 0
    field.reached = {"anna"}
    field.run(10.0)
    assert 2 <= field.states <= 2 + 10.0 / PERIOD
    field.reached = set()
    field.run(INTEREST + 5.0)
    before = field.states
    field.run(20.0)
    assert field.states == before


def test_the_summary_says_once_that_a_robot_has_finished() -> None:
    control = MissionControl("base", 1)
    control.on_robots(["anna", "bob"], 0.0)
    control.on_state(TeamState("anna", int(State.FINISHED), "finished, at home"), 0.0)
    control.on_state(TeamState("bob", int(State.RETURNING), "sent home, drives home"), 0.0)
    assert summary_of(control.members(0.0)) == "anna: finished, at home; bob: returning, sent home, drives home"


def test_bad_orders_are_refused_in_words() -> None:
    field = Field("anna")
    assert not field.control.order("stop").done
    assert field.control.order("dance").text.startswith("unknown order 'dance'; there are start, pause")
    assert field.control.order("stop", ["carl"]).text == "no robot carl was heard of; there are none yet"
    bench = field.robots["anna"]
    bench.agent.on_order(TeamOrder("base", 1, "dance"), 100.0)
    (told,) = [effect for effect in bench.run(0.4) if isinstance(effect, SendState)]
    assert not told.state.answer.done and told.state.answer.text.startswith("unknown order 'dance'")


def test_an_order_is_told_from_one_of_another_run_of_the_control() -> None:
    field = Field("anna")
    field.run(1.0)
    field.control.order("pause")
    field.run(1.0)
    field.control = MissionControl("base", 500)
    field.run(1.0)
    field.control.order("resume")
    field.run(1.0)
    assert field.robots["anna"].agent.state == State.EXPLORING


def test_nobody_is_in_reach_of_a_control_whose_radio_says_nothing() -> None:
    """Orders were "sent to bob" hours after adhoc_communication had died."""
    control = MissionControl("base", 0)
    control.on_robots(["bob"], 0.0)
    control.tick(1.0)
    assert control.order("stop").done
    assert control.tick(10.0) == []
    answer = control.order("stop")
    assert not answer.done and "adhoc_communication says nothing, is it running?" in answer.text
    assert not control.members(10.0)[0].in_reach
    control.on_robots(["bob"], 11.0)
    assert [send.order.order for send in control.tick(11.0)] == ["stop"]


def test_tables_are_bounded() -> None:
    control = MissionControl("base", 0)
    control.on_robots([f"r{number}" for number in range(5 * MOST_ROBOTS)], 0.0)
    assert len(control.members(0.0)) == MOST_ROBOTS
    control.on_state(TeamState("stranger", 1, "here"), 0.0)
    assert len(control.members(0.0)) == MOST_ROBOTS
    bench = Bench(7).map(corridor())
    for number in range(200):
        bench.agent.on_order(TeamOrder(f"base{number}", number, "pause"), bench.now)
    assert len([effect for effect in bench.run(0.4) if isinstance(effect, SendState)]) == MOST_CONTROLS


@pytest.mark.parametrize("count", [0, 1])
def test_the_summary_is_one_line(count: int) -> None:
    control = MissionControl("base", 0)
    control.on_robots(["anna"][:count], 0.0)
    assert summary_of(control.members(0.0)) == ("anna: has told nothing" if count else "no robot was heard of")
