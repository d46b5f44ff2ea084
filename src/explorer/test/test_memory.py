"""A node that is started anew goes on with its mission, whatever it was at."""

from typing import Any

import pytest
from test_agent import Bench, corridor
from test_orders import driving, final_log, of_kind

from explorer.agent import ExplorerAgent
from explorer.memory import Memory, MemoryTextError, memory_of
from explorer.messages import SetGoal
from explorer.status import State
from mr_grid import Pose


def started_anew(bench: Bench, later: float = 5.0, **options: Any) -> Bench:
    """The same robot `later` s afterwards, with nothing left but its memory."""
    text = bench.agent.memory.text()
    anew = Bench(7, **options)
    anew.agent = ExplorerAgent(anew.agent.options)
    anew.now = bench.now + later
    anew.agent.recall(memory_of(text), anew.now)
    anew.place(bench.pose.x, bench.pose.y)
    return anew.map(corridor())


def test_a_robot_explores_on_with_its_home_its_time_and_its_limits() -> None:
    bench = driving(time_limit=60.0, autostart=False)
    home = bench.agent.home
    bench.place(3.0, 0.0)
    bench.run(20.0)
    anew = started_anew(bench, time_limit=60.0, autostart=False)
    effects = anew.run(1.0)
    assert of_kind(SetGoal, effects) and anew.agent.state == State.EXPLORING
    assert anew.agent.home == home and anew.agent.exploration_time(anew.now) > 25.0
    assert anew.agent.counters.distance >= 2.0
    anew.run(40.0)
    assert anew.agent.text.startswith("time limit of 60 s reached") and anew.goals()[-1].pose == home


@pytest.mark.parametrize(
    ("order", "state", "text"),
    [
        ("pause", State.WAITING, "is paused"),
        ("return_now", State.RETURNING, "is called back, drives home"),
        ("stop", State.FINISHED, "stopped"),
        ("go_home", State.RETURNING, "sent home, drives home"),
    ],
)
def test_an_order_holds_on(order: str, state: State, text: str) -> None:
    bench = driving()
    bench.place(3.0, 0.0)
    getattr(bench.agent, order)(bench.now)
    bench.run(1.0)
    anew = started_anew(bench)
    effects = anew.run(10.0)
    assert (anew.agent.state, anew.agent.text) == (state, text)
    homeward = [goal.pose for goal in of_kind(SetGoal, effects)]
    assert set(homeward) == ({bench.agent.home} if state == State.RETURNING else set())


def test_a_mission_that_is_over_stays_so() -> None:
    bench = Bench(7).map(corridor(left=False, right=False))
    bench.run(20.0)
    time = bench.agent.exploration_time(bench.now)
    anew = started_anew(bench)
    anew.map(corridor(left=False, right=False)).run(20.0)
    assert anew.agent.state == State.FINISHED and anew.agent.text == "finished, at home"
    assert anew.agent.exploration_time(anew.now) == pytest.approx(time)
    assert "complete=1" in final_log(bench)


def not_begun() -> Bench:
    bench = Bench(7)
    bench.agent = ExplorerAgent(bench.agent.options)
    bench.agent.on_pose(Pose(1.0, 0.0, 0.0), bench.now)
    return bench


def test_a_robot_that_had_not_begun_begins() -> None:
    anew = started_anew(not_begun())
    assert anew.agent.home == Pose(1.0, 0.0, 0.0) and anew.agent.started_at is None
    assert anew.agent.start(anew.now)
    assert of_kind(SetGoal, anew.run(2.0)) and anew.agent.state == State.EXPLORING


def test_a_robot_that_was_stopped_before_it_had_begun_stays_so() -> None:
    """Its node, started again, drove off."""
    bench = not_begun()
    assert bench.agent.stop(bench.now).done
    anew = started_anew(bench)
    assert not anew.agent.start(anew.now)
    assert not of_kind(SetGoal, anew.run(2.0))
    assert (anew.agent.state, anew.agent.text) == (State.FINISHED, "stopped")
    assert anew.agent.exploration_time(anew.now) == 0.0 and anew.agent.memory.ended_by == "stopped"


@pytest.mark.parametrize(
    ("order", "text"),
    [("go_home", "sent home, at home"), ("return_now", "is called back, waits for the start")],
    ids=["sent home", "called back"],
)
def test_a_robot_that_was_ordered_home_before_it_had_begun_stays_there(order: str, text: str) -> None:
    bench = not_begun()
    assert getattr(bench.agent, order)(bench.now).done
    anew = started_anew(bench, autostart=False)
    anew.place(1.0, 0.0)
    assert not of_kind(SetGoal, anew.run(2.0)) and anew.agent.text == text


def test_a_mission_of_another_clock_starts_anew() -> None:
    bench = driving()
    anew = Bench(7)
    anew.agent = ExplorerAgent(anew.agent.options)
    anew.agent.recall(bench.agent.memory, 3.0)
    assert anew.agent.started_at == 3.0 and anew.agent.home == bench.agent.home


@pytest.mark.parametrize(
    ("order", "state"), [("go_home", State.RETURNING), ("stop", State.FINISHED)], ids=["sent home", "stopped"]
)
def test_an_order_that_ended_a_mission_of_another_clock_holds_on(order: str, state: State) -> None:
    bench = driving()
    bench.place(3.0, 0.0)
    getattr(bench.agent, order)(bench.now)
    anew = started_anew(bench, later=-90.0)
    anew.run(1.0)
    assert anew.agent.state == state and anew.agent.finished_at is not None
    assert anew.agent.exploration_time(anew.now) == 0.0


def test_memory_is_the_same_after_it_was_a_text() -> None:
    memory = Memory(Pose(1.0, 2.0, 0.5), 10.0, 20.0, "stopped", False, "is paused", 7.0)
    assert memory_of(memory.text()) == memory and memory_of(Memory().text()) == Memory()


@pytest.mark.parametrize(
    "text",
    ["", "no", "[]", "{}", '{"home": ["x", 0, 0]}', '{"home": null, "who": 1}', Memory(distance=float("nan")).text(),
     Memory(started_at="now").text()],  # type: ignore[arg-type]
)  # fmt: skip
def test_what_is_no_memory_is_refused_in_one_sentence(text: str) -> None:
    with pytest.raises(MemoryTextError, match="the mission starts anew"):
        memory_of(text)
