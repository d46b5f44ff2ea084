"""SLAM is started anew in the middle of a mission: its map begins again, in a frame of its own."""

import math
from typing import Any, Optional

import pytest
from test_agent import Bench, corridor
from test_memory import started_anew
from test_orders import driving, of_kind

from explorer.foreign import Element
from explorer.homecoming import HOME_LOST
from explorer.messages import CancelGoal, Note, SendStatement, SetGoal
from explorer.status import State
from mr_grid import Pose

SHIFT = Pose(-3.0, 0.5, math.pi)  # the former frame in the new one


def restarted(bench: Bench, shift: Optional[Pose], occupancy: Any = None) -> Bench:
    """SLAM begins anew where the robot is."""
    bench.agent.on_new_frame(shift, bench.now)
    bench.place(0.0, 0.0)
    return bench.map(corridor() if occupancy is None else occupancy)


def exploring(**options: Any) -> Bench:
    bench = driving(**options)
    bench.place(3.0, 0.0)
    bench.run(5.0)
    return bench


def test_the_goal_of_the_former_frame_is_dropped_and_the_new_map_explored() -> None:
    bench = exploring()
    bench.agent.on_new_frame(SHIFT, bench.now)
    effects = bench.tick()
    assert of_kind(CancelGoal, effects) and not of_kind(SetGoal, effects)
    assert (bench.agent.state, bench.agent.text) == (State.STARTING, "waits for the map")
    bench.map(corridor(left=False))
    bench.place(2.0, 0.0)
    goals = of_kind(SetGoal, bench.run(2.0))
    assert goals and all(goal.pose.x > 2.0 for goal in goals) and bench.agent.state == State.EXPLORING


def test_what_was_decided_in_the_former_frame_does_not_hold_in_the_new_one() -> None:
    """Once places of the former map were no goals in the new one."""
    bench = exploring()
    while bench.agent.goal is not None:
        bench.agent.on_goal_result(bench.agent.goal.goal_id, "failed", "no way", bench.now)
        bench.run(1.0)
        if bench.now > 200.0:
            break
    assert any(verdict.given_up for verdict in bench.verdicts())
    restarted(bench, SHIFT).run(2.0)
    assert bench.verdicts() and not any(verdict.given_up for verdict in bench.verdicts())
    assert bench.agent.goal is not None


def test_home_is_where_it_was() -> None:
    """Once the robot drove to the place that has the same numbers in the new frame."""
    bench = exploring()
    restarted(bench, SHIFT).run(1.0)
    home = bench.agent.home
    assert home is not None and home == pytest.approx(Pose(-3.5, 0.5, math.pi))
    assert bench.agent.go_home(bench.now).done
    assert of_kind(SetGoal, bench.run(1.0))[-1].pose == home


def test_where_nothing_ties_the_frames_the_robot_does_not_go_where_its_home_is_not() -> None:
    bench = exploring(time_limit=30.0)
    restarted(bench, None)
    effects = bench.run(1.0)
    assert any(HOME_LOST in note.text for note in of_kind(Note, effects))
    assert bench.agent.home is None and bench.agent.goal is not None
    for order in (bench.agent.go_home, bench.agent.return_now):
        answer = order(bench.now)
        assert (answer.done, answer.text) == (False, HOME_LOST)
    effects = bench.run(30.0)
    assert (bench.agent.state, bench.agent.goal) == (State.FINISHED, None)
    assert bench.agent.text == f"time limit of 30 s reached, {HOME_LOST}"
    anew = started_anew(bench, time_limit=30.0)
    anew.run(1.0)
    assert anew.agent.home is None and anew.agent.text.endswith(HOME_LOST)


def test_a_robot_that_was_called_back_and_does_not_know_its_home_waits() -> None:
    bench = exploring()
    bench.agent.return_now(bench.now)
    restarted(bench, None).run(1.0)
    assert (bench.agent.state, bench.agent.goal) == (State.WAITING, None)
    assert bench.agent.text == f"is called back, {HOME_LOST}"
    assert bench.agent.resume(bench.now).done
    assert of_kind(SetGoal, bench.run(2.0))


def test_time_way_and_limits_go_on() -> None:
    """Once the jump from one frame to the other was a way driven."""
    bench = exploring(distance_limit=20.0)
    driven, time = bench.agent.counters.distance, bench.agent.exploration_time(bench.now)
    bench.place(9.0, 0.0)
    restarted(bench, SHIFT).run(1.0)
    assert bench.agent.counters.distance == pytest.approx(driven + 6.0)
    assert bench.agent.exploration_time(bench.now) == pytest.approx(time + 1.0)


@pytest.mark.parametrize(("order", "state", "text"), [
    ("pause", State.WAITING, "is paused"),
    ("return_now", State.RETURNING, "is called back, drives home"),
    ("stop", State.FINISHED, "stopped"),
    ("go_home", State.RETURNING, "sent home, drives home"),
])  # fmt: skip
def test_an_order_holds_on(order: str, state: State, text: str) -> None:
    bench = exploring()
    getattr(bench.agent, order)(bench.now)
    bench.run(1.0)
    restarted(bench, SHIFT).run(2.0)
    assert (bench.agent.state, bench.agent.text) == (state, text)


def test_a_robot_that_was_at_the_end_explores_again_what_its_map_has_lost() -> None:
    bench = Bench(7).map(corridor(left=False, right=False))
    bench.run(20.0)
    assert (bench.agent.state, bench.agent.text) == (State.FINISHED, "finished, at home")
    here = bench.pose.inverse()
    restarted(bench, here, corridor(left=False, right=False)).run(20.0)
    assert (bench.agent.state, bench.agent.text) == (State.FINISHED, "finished, at home")
    restarted(bench, here, corridor()).run(20.0)
    assert bench.agent.state == State.EXPLORING


def test_others_are_where_the_new_transforms_say() -> None:
    bench = exploring()
    bench.join("robot_1", position=(8.0, 0.0)).run(3.0)
    bench.agent.on_frontiers([Element("robot_1", 1, 2.0, 0.0)], bench.now)
    before = of_kind(SendStatement, bench.effects)[-1].statement
    assert bench.agent.foreign.places("robot_1")
    restarted(bench, SHIFT).run(12.0)
    assert not bench.agent.foreign.places("robot_1")
    after = of_kind(SendStatement, bench.effects)[-1].statement
    assert after.mission != before.mission, "others forget what was told in the former frame"
    assert "robot_1" in bench.agent.mission.team.known()


def test_a_result_of_the_former_goal_ends_none_of_the_new_frame() -> None:
    bench = exploring()
    former = bench.agent.goal
    assert former is not None
    restarted(bench, SHIFT).run(1.0)
    bench.agent.on_goal_result(former.goal_id, "failed", "the goal was in the frame of before", bench.now)
    assert bench.agent.goal is not None and bench.agent.goal.goal_id > former.goal_id


@pytest.mark.parametrize("strategy", range(8))
def test_every_strategy_goes_on(strategy: int) -> None:
    bench = driving(strategy)
    bench.join("robot_1").run(1.0)
    assert of_kind(SetGoal, restarted(bench, SHIFT).run(3.0))
