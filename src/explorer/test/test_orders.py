"""Orders and limits on virtual time: a robot that is paused, stopped, sent home, or out of time."""

import math
from typing import Any, Callable, List

import pytest
from test_agent import Bench, corridor, reply
from usual_robot import options_with

from explorer.agent import ExplorerAgent
from explorer.answer import Answer
from explorer.messages import Auction, CancelGoal, Note, SendAuction, SendState, SetGoal, WriteLog
from explorer.status import State
from explorer.team_state import TeamOrder
from mr_grid import Pose


def of_kind(kind: type, effects: List[Any]) -> List[Any]:
    return [effect for effect in effects if isinstance(effect, kind)]


def driving(strategy: int = 7, **options: Any) -> Bench:
    bench = Bench(strategy, **options).map(corridor())
    bench.run(1.0)
    assert bench.agent.goal is not None
    return bench


def order(bench: Bench, what: Callable[[float], Answer]) -> Answer:
    return what(bench.now)


def final_log(bench: Bench) -> str:
    (log,) = [effect for effect in of_kind(WriteLog, bench.effects) if effect.name == "exploration.log"]
    return str(log.text)


@pytest.mark.parametrize("strategy", range(8))
def test_a_paused_robot_stays_where_it_is_and_goes_on_when_told(strategy: int) -> None:
    bench = driving(strategy)
    assert order(bench, bench.agent.pause) == Answer(True, "paused")
    effects = bench.run(0.2)
    assert len(of_kind(CancelGoal, effects)) == 1
    effects = bench.map(corridor(left=False)).run(60.0)
    assert not of_kind(SetGoal, effects) and bench.agent.state == State.WAITING and bench.agent.text == "is paused"
    assert order(bench, bench.agent.resume).done
    assert of_kind(SetGoal, bench.run(2.0)) and bench.agent.state == State.EXPLORING


def test_a_paused_robot_frees_its_claim_and_bids_for_nothing() -> None:
    bench = Bench(7).map(corridor()).join("robot_1", position=(8.0, 0.0))
    bench.run(0.4)
    start = next(auction for auction in bench.auctions() if auction.start)
    bench.agent.on_auction(reply(start, "robot_1", [50.0] * len(start.requested)), bench.now)
    bench.run(1.0)
    assert bench.auctions()[-1].occupied, "it has claimed a cluster"
    offered = start.requested[0]

    def answer() -> Auction:
        bench.agent.on_auction(Auction("robot_1", 77, True, start=True, requested=(offered,)), bench.now)
        return [effect.auction for effect in of_kind(SendAuction, bench.run(0.2)) if not effect.auction.status][-1]

    assert [bid.bid > 0 for bid in answer().available] == [True]
    order(bench, bench.agent.pause)
    closing = [effect.auction for effect in of_kind(SendAuction, bench.run(0.2))][-1]
    assert closing.finished and closing.occupied == ()
    assert answer().available == ()
    assert not any(effect.auction.start or effect.auction.occupied for effect in of_kind(SendAuction, bench.run(30.0)))
    order(bench, bench.agent.resume)
    assert [bid.bid > 0 for bid in answer().available] == [True]


def test_a_paused_robot_still_tells_what_it_sees() -> None:
    bench = Bench(7).map(corridor(left=False, right=False)).join("robot_1")
    bench.run(1.0)
    order(bench, bench.agent.pause)
    bench.map(corridor())
    sent = [effect for effect in bench.run(3.0) if getattr(effect, "topic", "") == "frontiers"]
    assert sent and sent[0].elements


def test_nothing_ends_while_a_robot_is_paused() -> None:
    """Nothing is left on its map, and its time is up: it says so when it goes on."""
    bench = driving(time_limit=10.0)
    order(bench, bench.agent.pause)
    bench.map(corridor(left=False, right=False)).run(60.0)
    assert bench.agent.state == State.WAITING and bench.agent.finished_at is None
    order(bench, bench.agent.resume)
    bench.run(1.0)
    assert bench.agent.finished_at is not None and "time limit of 10 s reached" in bench.agent.text


def test_stop_ends_the_mission_where_the_robot_is() -> None:
    bench = driving()
    bench.place(3.0, 0.0)
    assert order(bench, bench.agent.stop).done
    effects = bench.run(30.0)
    assert len(of_kind(CancelGoal, effects)) == 1 and not of_kind(SetGoal, effects)
    assert bench.agent.state == State.FINISHED and bench.agent.text == "stopped"
    assert "complete=0\n" in final_log(bench)
    ended, left = [note.text for note in of_kind(Note, effects)]
    assert ended == "exploration ended after 1.0 s: stopped" and left.startswith("left unexplored at 2 places")
    assert not bench.agent.start(bench.now), "it is not started again"


def test_nothing_is_said_of_what_is_left_where_no_map_has_come() -> None:
    """It said that nothing was."""
    bench = Bench(7)
    bench.agent.start(bench.now)
    bench.run(1.0)
    assert order(bench, bench.agent.stop).done
    notes = [note.text for note in of_kind(Note, bench.run(1.0))]
    assert notes == ["exploration ended after 1.0 s: stopped"]


@pytest.mark.parametrize("before", ["exploring", "stopped", "paused"])
def test_go_home(before: str) -> None:
    """Also a robot that is not to return by itself."""
    bench = driving(return_home=False)
    home = bench.agent.home
    bench.place(3.0, 0.0)
    if before != "exploring":
        order(bench, bench.agent.stop if before == "stopped" else bench.agent.pause)
        bench.run(1.0)
    assert order(bench, bench.agent.go_home) == Answer(True, "drives home")
    effects = bench.run(1.0)
    assert [goal.pose for goal in of_kind(SetGoal, effects)] == [home]
    assert bench.agent.state == State.RETURNING and "complete=0\n" in final_log(bench)
    assert home is not None
    bench.place(home.x, home.y)
    bench.run(1.0)
    assert bench.agent.state == State.FINISHED and bench.agent.text.endswith("at home")


def test_a_pause_on_the_way_home() -> None:
    bench = driving()
    bench.place(3.0, 0.0)
    order(bench, bench.agent.go_home)
    bench.run(1.0)
    order(bench, bench.agent.pause)
    effects = bench.run(10.0)
    assert of_kind(CancelGoal, effects) and not of_kind(SetGoal, effects)
    order(bench, bench.agent.resume)
    assert of_kind(SetGoal, bench.run(1.0))[0].pose == bench.agent.home


def test_the_time_limit_sends_the_robot_home() -> None:
    bench = driving(time_limit=20.0)
    bench.place(3.0, 0.0)
    bench.run(18.8)
    assert bench.agent.finished_at is None
    bench.run(0.6)
    assert bench.agent.finished_at == pytest.approx(120.0, abs=0.21)
    assert bench.agent.state == State.RETURNING and bench.goals()[-1].pose == bench.agent.home
    assert "complete=0\n" in final_log(bench) and "exploration_time=20." in final_log(bench)
    assert any("time limit of 20 s reached" in note.text for note in of_kind(Note, bench.effects))


def test_the_distance_limit_sends_the_robot_home() -> None:
    bench = driving(distance_limit=5.0)
    for step in range(60):
        bench.place(0.5 + 0.1 * (step % 20 if step % 40 < 20 else 20 - step % 20), 0.0)
        bench.run(0.2)
        if bench.agent.finished_at is not None:
            break
    assert 5.0 <= bench.agent.counters.distance < 5.3
    assert bench.agent.text.startswith("distance limit of 5 m reached")


def test_limits_can_be_set_while_a_robot_explores() -> None:
    """In place of those that it began with, whatever the clock does and wherever its map begins anew."""
    bench = driving(time_limit=20.0, distance_limit=5.0, progress_timeout=1e5)
    assert bench.agent.set_limits(40.0, 0.0) == Answer(True, "ends after 40 s")
    assert bench.agent.report(bench.now).limits == (40.0, 0.0)
    bench.run(30.0)
    assert bench.agent.finished_at is None
    bench.agent.on_new_frame(Pose(), bench.now)
    bench.map(corridor()).place(0.0, 0.0)
    bench.run(10.0)
    assert bench.agent.finished_at == pytest.approx(140.0, abs=0.5)
    refused = bench.agent.set_limits(0.0, 0.0)
    assert not refused.done and refused.text.startswith("has ended: time limit of 40 s reached")


def test_limits_that_are_set_hold_when_the_clock_is_set_back() -> None:
    bench = driving(time_limit=20.0)
    bench.agent.set_limits(0.0, 90.5)
    bench.now -= 50.0
    bench.run(0.4)
    assert bench.agent.report(bench.now).limits == (0.0, 90.5)


@pytest.mark.parametrize(
    ("time", "distance", "why"),
    [(-1.0, 0.0, "~time_limit is -1.0, out of range"), (0.0, math.nan, "~distance_limit is nan, out of range")],
)
def test_limits_that_are_none_are_refused(time: float, distance: float, why: str) -> None:
    bench = driving(time_limit=20.0)
    refused = bench.agent.set_limits(time, distance)
    assert not refused.done and why in refused.text and bench.agent.report(bench.now).limits == (20.0, 0.0)


def test_without_limits_a_robot_explores_for_ever() -> None:
    bench = driving(progress_timeout=3600.0)
    bench.run(2000.0, step=5.0)
    assert bench.agent.finished_at is None


def test_a_mission_that_finds_its_end_is_complete() -> None:
    bench = Bench(7).map(corridor(left=False, right=False))
    bench.run(20.0)
    assert bench.agent.state == State.FINISHED and "complete=1\n" in final_log(bench)
    assert any(note.text.startswith("exploration finished after") for note in of_kind(Note, bench.effects))


def test_a_robot_that_is_called_back_drives_home_and_goes_on_when_told() -> None:
    bench = driving(return_home=False)
    bench.place(3.0, 0.0)
    assert order(bench, bench.agent.return_now) == Answer(True, "drives home")
    effects = bench.run(1.0)
    assert [goal.pose for goal in of_kind(SetGoal, effects)] == [bench.agent.home]
    assert bench.agent.state == State.RETURNING and bench.agent.text == "is called back, drives home"
    assert order(bench, bench.agent.return_now) == Answer(False, "is called back already")
    bench.place(0.5, 0.0)
    effects = bench.run(60.0)
    assert bench.agent.state == State.WAITING and bench.agent.text == "is called back, at home"
    assert bench.agent.finished_at is None and not of_kind(SetGoal, effects)
    assert order(bench, bench.agent.resume).done
    assert of_kind(SetGoal, bench.run(2.0)) and bench.agent.state == State.EXPLORING


def test_a_robot_on_its_way_back_can_be_paused_sent_on_or_stopped() -> None:
    for then, state in (("pause", State.WAITING), ("resume", State.EXPLORING), ("stop", State.FINISHED)):
        bench = driving()
        bench.place(3.0, 0.0)
        order(bench, bench.agent.return_now)
        bench.run(1.0)
        assert getattr(bench.agent, then)(bench.now).done
        bench.run(3.0)
        assert bench.agent.state == state, then


def test_a_robot_that_has_ended_is_not_called_back() -> None:
    bench = driving()
    order(bench, bench.agent.stop)
    assert order(bench, bench.agent.return_now) == Answer(False, "has ended: stopped")


def test_a_robot_that_is_on_its_way_back_can_be_sent_home_for_good() -> None:
    """The order was refused, "is on its way home already", and at home the robot waited to be resumed."""
    bench = driving()
    bench.place(3.0, 0.0)
    order(bench, bench.agent.return_now)
    bench.run(1.0)
    assert order(bench, bench.agent.go_home) == Answer(True, "drives home")
    bench.place(0.5, 0.0)
    bench.run(1.0)
    assert (bench.agent.state, bench.agent.text) == (State.FINISHED, "sent home, at home")


def test_refusals_say_why() -> None:
    bench = driving()
    assert order(bench, bench.agent.resume) == Answer(False, "is not paused")
    order(bench, bench.agent.pause)
    assert order(bench, bench.agent.pause) == Answer(False, "is paused already")
    bench.place(3.0, 0.0)
    order(bench, bench.agent.go_home)
    assert order(bench, bench.agent.go_home) == Answer(False, "is on its way home already")
    order(bench, bench.agent.stop)
    assert order(bench, bench.agent.stop) == Answer(False, "has ended already: stopped")
    assert order(bench, bench.agent.pause) == Answer(False, "has ended: stopped")
    bench.place(0.5, 0.0)
    assert order(bench, bench.agent.go_home) == Answer(False, "is at home")


def test_a_robot_that_waits_for_its_map_can_be_paused() -> None:
    """The order was refused, and of a team that was paused the one robot drove off whose SLAM had started again."""
    bench = Bench(7)
    bench.run(1.0)
    assert order(bench, bench.agent.pause) == Answer(True, "is paused, waits for the map")
    assert order(bench, bench.agent.pause) == Answer(False, "is paused already")
    bench.run(1.0)
    assert (bench.agent.state, bench.agent.text) == (State.STARTING, "is paused, waits for the map")
    bench.map(corridor())
    assert not of_kind(SetGoal, bench.run(5.0))
    assert (bench.agent.state, bench.agent.text) == (State.WAITING, "is paused")
    assert order(bench, bench.agent.resume).done
    assert of_kind(SetGoal, bench.run(5.0))


def unstarted(**options: Any) -> Bench:
    """It has map and pose, and waits for the start."""
    bench = Bench(7, **options)
    bench.agent = ExplorerAgent(options_with(robot_name="robot_0", autostart=False, **options))
    bench.map(corridor()).run(1.0)
    assert bench.agent.text == "waits for the start"
    return bench


@pytest.mark.parametrize("radio", [False, True], ids=["service", "mission control"])
def test_a_robot_that_is_called_back_before_its_start_waits_at_home_until_it_is_resumed(radio: bool) -> None:
    """The order was refused, and the robot drove off with the start."""
    bench = unstarted()
    if radio:
        bench.agent.on_order(TeamOrder("base", 1, "return_now"), bench.now)
        told = [effect.state.answer for effect in of_kind(SendState, bench.run(1.0))]
        assert told == [Answer(True, "is called back, waits for the start")]
    else:
        assert order(bench, bench.agent.return_now) == Answer(True, "is called back, waits for the start")
    assert order(bench, bench.agent.return_now) == Answer(False, "is called back already")
    bench.run(5.0)
    assert (bench.agent.state, bench.agent.text) == (State.STARTING, "is called back, waits for the start")
    assert bench.agent.exploration_time(bench.now) == 0.0
    assert order(bench, bench.agent.order_start) == Answer(
        True, "exploration started; the robot is called back until it is resumed"
    )
    assert not of_kind(SetGoal, bench.run(5.0))
    assert (bench.agent.state, bench.agent.text) == (State.WAITING, "is called back, at home")
    assert order(bench, bench.agent.resume).done
    assert of_kind(SetGoal, bench.run(2.0)) and bench.agent.state == State.EXPLORING


def test_a_robot_that_is_resumed_before_its_start_explores_with_it() -> None:
    bench = unstarted()
    order(bench, bench.agent.pause)
    assert order(bench, bench.agent.return_now) == Answer(True, "is called back, waits for the start")
    assert order(bench, bench.agent.resume).done
    assert not of_kind(SetGoal, bench.run(2.0)) and bench.agent.text == "waits for the start"
    assert order(bench, bench.agent.order_start) == Answer(True, "exploration started")
    assert of_kind(SetGoal, bench.run(2.0))


def test_a_robot_that_is_sent_home_before_its_start_stays_there_and_never_starts() -> None:
    """The order was refused, and the robot drove off with the start."""
    bench = unstarted(return_home=False)
    assert order(bench, bench.agent.go_home) == Answer(True, "stays at home")
    effects = bench.run(5.0)
    assert (bench.agent.state, bench.agent.text) == (State.FINISHED, "sent home, at home")
    assert [note.text for note in of_kind(Note, effects)] == ["exploration ended before it began: sent home"]
    assert order(bench, bench.agent.go_home) == Answer(False, "is at home")
    assert order(bench, bench.agent.order_start) == Answer(
        False, "has ended: sent home, at home; a new mission begins with a new launch"
    )
    assert not of_kind(SetGoal, bench.run(5.0)) and bench.agent.exploration_time(bench.now) == 0.0


def test_a_robot_that_waits_for_its_map_can_be_sent_home() -> None:
    bench = Bench(7)
    bench.run(1.0)
    assert order(bench, bench.agent.go_home) == Answer(True, "sent home, waits for the map")
    assert order(bench, bench.agent.go_home) == Answer(False, "is on its way home already")
    bench.run(1.0)
    assert (bench.agent.state, bench.agent.text) == (State.STARTING, "sent home, waits for the map")
    assert not of_kind(SetGoal, bench.map(corridor()).run(5.0))
    assert (bench.agent.state, bench.agent.text) == (State.FINISHED, "sent home, at home")


@pytest.mark.parametrize("stopped", [False, True], ids=["waiting", "stopped"])
def test_a_robot_whose_home_is_elsewhere_drives_there_when_it_is_sent_home_before_its_start(stopped: bool) -> None:
    bench = unstarted(home_pose=(2.5, 0.0, 0.0))
    if stopped:
        order(bench, bench.agent.stop)
        bench.run(1.0)
    assert order(bench, bench.agent.go_home) == Answer(True, "drives home")
    assert [goal.pose for goal in of_kind(SetGoal, bench.run(1.0))] == [Pose(2.5, 0.0, 0.0)]
    bench.place(2.5, 0.0)
    bench.run(1.0)
    ended = "stopped" if stopped else "sent home"
    assert (bench.agent.state, bench.agent.text) == (State.FINISHED, f"{ended}, at home")


def test_a_clock_that_is_set_back_does_not_start_a_robot_that_was_sent_home_before_its_start() -> None:
    bench = unstarted()
    order(bench, bench.agent.go_home)
    bench.run(1.0)
    bench.now = 5.0
    assert not of_kind(SetGoal, bench.run(5.0))
    assert (bench.agent.state, bench.agent.text) == (State.FINISHED, "sent home, at home")


def test_what_started_or_ended_is_not_started_again_and_says_so() -> None:
    bench = driving()
    assert order(bench, bench.agent.order_start) == Answer(False, "exploration was started before")
    order(bench, bench.agent.stop)
    assert order(bench, bench.agent.order_start) == Answer(
        False, "has ended: stopped; a new mission begins with a new launch"
    )


def test_a_robot_that_is_stopped_before_its_start_never_starts() -> None:
    bench = Bench(7, autostart=False)
    agent = Bench(7).agent
    agent = type(agent)(bench.agent.options)
    assert agent.stop(100.0).done and not agent.start(101.0)
    agent.on_global_map(corridor(), 101.0)
    agent.on_pose(bench.pose, 101.0)
    assert not any(of_kind(SetGoal, agent.tick(101.0 + step)) for step in range(10))
    assert agent.state == State.FINISHED


@pytest.mark.parametrize("stopped", [False, True], ids=["exploring", "stopped"])
@pytest.mark.parametrize("paused", [False, True], ids=["driving", "paused"])
def test_a_clock_that_is_set_back_makes_no_robot_explore_that_was_sent_home(stopped: bool, paused: bool) -> None:
    bench = driving()
    bench.place(3.0, 0.0)
    if stopped:
        order(bench, bench.agent.stop)
    order(bench, bench.agent.go_home)
    bench.run(1.0)
    if paused:
        order(bench, bench.agent.pause)
    bench.now = 5.0
    effects = bench.run(10.0)
    if paused:
        assert not of_kind(SetGoal, effects) and bench.agent.text == "is paused"
        order(bench, bench.agent.resume)
        effects = bench.run(1.0)
    assert [goal.pose for goal in of_kind(SetGoal, effects)] == [bench.agent.home]
    assert bench.agent.text == ("stopped, drives home" if stopped else "sent home, drives home")
    assert bench.agent.home is not None
    bench.place(bench.agent.home.x, bench.agent.home.y)
    bench.run(5.0)
    bench.now = 3.0
    assert not of_kind(SetGoal, bench.run(10.0)) and bench.agent.state == State.FINISHED


def test_a_clock_that_is_set_forward_ends_no_mission() -> None:
    bench = driving(time_limit=600.0, progress_timeout=1e5)
    bench.run(30.0)
    bench.now += 3600.0
    bench.run(5.0)
    assert bench.agent.finished_at is None and bench.agent.exploration_time(bench.now) == pytest.approx(36.0, abs=0.5)
    assert [note.text for note in of_kind(Note, bench.effects) if note.warning] == [
        "time went forward by 3600.2 s, which do not count"
    ]
    bench.now += 59.0
    bench.run(5.0)
    assert bench.agent.exploration_time(bench.now) == pytest.approx(100.0, abs=0.5)
    bench.run(510.0)
    assert bench.agent.finished_at is not None and "exploration_time=600." in final_log(bench)


def test_what_begins_or_has_ended_is_not_moved_by_a_clock_that_is_set_forward() -> None:
    bench = Bench(7).map(corridor())
    bench.agent = ExplorerAgent(bench.agent.options)
    bench.map(corridor()).run(1.0)
    bench.now += 3600.0
    bench.agent.start(bench.now)
    bench.run(2.0)
    assert bench.agent.exploration_time(bench.now) == pytest.approx(2.0, abs=0.3)
    order(bench, bench.agent.stop)
    bench.now += 3600.0
    bench.run(1.0)
    assert bench.agent.exploration_time(bench.now) == pytest.approx(2.0, abs=0.3)
    assert not [note for note in of_kind(Note, bench.effects) if note.warning]


@pytest.mark.parametrize("what, state", [("pause", State.WAITING), ("stop", State.FINISHED)])
def test_a_clock_that_is_set_back_does_not_make_a_halted_robot_drive(what: str, state: State) -> None:
    bench = driving()
    order(bench, getattr(bench.agent, what))
    bench.run(1.0)
    bench.now = 5.0
    assert not of_kind(SetGoal, bench.run(10.0)) and bench.agent.state == state


def test_a_robot_that_was_stopped_drives_home_when_told_after_the_clock_was_set_back() -> None:
    """Its node died with the next step."""
    bench = driving()
    bench.place(3.0, 0.0)
    order(bench, bench.agent.stop)
    bench.run(1.0)
    bench.now = 5.0
    bench.run(1.0)
    assert order(bench, bench.agent.go_home).done
    effects = bench.run(5.0)
    assert [goal.pose for goal in of_kind(SetGoal, effects)] == [bench.agent.home]
    assert bench.agent.state == State.RETURNING


@pytest.mark.parametrize("autostart, last", [(True, "waits for move_base"), (False, "waits for the start")])
def test_a_robot_that_has_not_begun_tells_what_it_waits_for(autostart: bool, last: str) -> None:
    """It said "waits for the start" also where only its map was missing."""
    agent = ExplorerAgent(options_with(robot_name="robot_0", autostart=autostart))
    agent.tick(0.0)
    assert agent.text == "waits for the map"
    agent.on_global_map(corridor(), 1.0)
    agent.tick(1.0)
    assert agent.text == "waits for the robot's pose"
    agent.on_pose(Pose(0.5, 0.0, 0.0), 2.0)
    agent.tick(2.0)
    assert agent.text == last
