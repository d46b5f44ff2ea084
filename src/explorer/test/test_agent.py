"""The agent on virtual time: goals, failures, the end, auctions under loss, duplication and reordering."""

from dataclasses import replace
from typing import Any, List, Optional

import numpy as np
import pytest
from conftest import map_of
from usual_robot import options_with

from explorer.agent import ExplorerAgent
from explorer.foreign import Element
from explorer.messages import (
    FAILED,
    REACHED,
    REPLACED,
    Auction,
    Bid,
    CancelGoal,
    LogOutput,
    Note,
    SendAuction,
    SendFrontiers,
    SetGoal,
    WriteLog,
)
from explorer.status import State
from explorer.travel import TravelGrid
from explorer.verdicts import Verdict
from mr_grid import Pose

IDENTITY = np.array([[1.0, 0, 0], [0, 1.0, 0]])


def corridor(left: bool = True, right: bool = True) -> Any:
    """20 m x 3 m, known in the middle; its ends are known up to the wall where `left` / `right` is False."""
    cells = np.full((32, 202), -1, dtype=np.int8)
    first, last = (60 if left else 1), (140 if right else 201)
    cells[1:31, first:last] = 0
    cells[0, first:last] = cells[31, first:last] = 100
    if not left:
        cells[:, 0] = 100
    if not right:
        cells[:, 201] = 100
    return map_of(cells, 0.1, x=-10.0, y=-1.6)


class Bench:
    """An agent with a clock: keeps the effects, accepts goals unless it is deaf, does not move by itself."""

    def __init__(self, strategy: int = 7, robot_name: str = "robot_0", **options: Any) -> None:
        self.agent = ExplorerAgent(options_with(frontier_selection=strategy, robot_name=robot_name, **options))
        self.now = 100.0
        self.effects: List[Any] = []
        self.deaf = False
        self.pose = Pose(0.5, 0.0, 0.0)
        self.agent.start(self.now)

    def map(self, occupancy: Any) -> "Bench":
        self.agent.on_global_map(occupancy, self.now)
        self.agent.on_own_map(self.now)
        return self

    def run(self, seconds: float, step: float = 0.2) -> List[Any]:
        new: List[Any] = []
        end = self.now + seconds
        while self.now < end - 1e-6:
            self.now += step
            self.agent.on_pose(self.pose, self.now)
            new += self.tick()
        return new

    def tick(self) -> List[Any]:
        effects = self.agent.tick(self.now)
        for effect in effects:
            if isinstance(effect, SetGoal) and not self.deaf:
                self.agent.on_goal_accepted(effect.goal_id, self.now)
        self.effects += effects
        return effects

    def place(self, x: float, y: float, yaw: float = 0.0) -> None:
        self.pose = Pose(x, y, yaw)
        self.agent.on_pose(self.pose, self.now)

    def verdicts(self) -> List[Verdict]:
        frontiers = self.agent.perception.frontiers.ordered()
        return [self.agent.mission.verdicts.of(frontier.number) for frontier in frontiers]

    def unreachable(self) -> int:
        return self.agent.status(self.now).unreachable

    def goals(self) -> List[SetGoal]:
        return [e for e in self.effects if isinstance(e, SetGoal)]

    def auctions(self) -> List[Auction]:
        return [e.auction for e in self.effects if isinstance(e, SendAuction)]

    def join(self, *names: str, position: Optional[tuple] = None) -> "Bench":
        self.agent.on_robots(list(names), self.now)
        if position is not None:
            self.agent.on_positions({name: position for name in names}, self.now)
        for name in names:
            self.agent.on_transform(name, IDENTITY, self.now)
        return self


def reply(start: Auction, robot: str, bids: List[float]) -> Auction:
    available = tuple(Bid(offer.elements, bid) for offer, bid in zip(start.requested, bids))
    return Auction(robot, start.auction_id, status=False, available=available, unit=start.unit)


# ---- goals ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("strategy", range(8))
def test_every_strategy_sends_a_goal_that_sees_a_frontier(strategy: int) -> None:
    bench = Bench(strategy).map(corridor())
    bench.run(1.0)
    goal = bench.goals()[0].pose
    assert abs(abs(goal.x + 0.0) - 4.0) < 1.6 and abs(goal.y) < 1.6 - 0.25
    assert abs(abs(goal.yaw) - (0.0 if goal.x > 0 else np.pi)) < 1.6
    assert bench.agent.state == State.EXPLORING


def test_nearest_and_furthest() -> None:
    for strategy, side in ((0, 1), (3, 1), (7, 1), (2, -1)):
        bench = Bench(strategy).map(corridor())
        bench.place(1.5, 0.0)
        bench.run(1.0)
        assert bench.goals()[0].pose.x * side > 0, strategy


def test_path_length_and_euclidean_distance_differ() -> None:
    """A wall between the robot and the nearer frontier: strategy 3 takes it, strategy 0 takes the shorter way."""
    cells = np.full((100, 100), -1, dtype=np.int8)
    cells[10:90, 10:90] = 0
    cells[60, 10:70] = 100
    cells[10:90, 10] = cells[10:90, 89] = cells[10, 10:90] = 100
    cells[10, 30:50] = 0
    cells[5:10, 30:50] = 0
    bench = {strategy: Bench(strategy).map(map_of(cells, 0.1)) for strategy in (0, 3)}
    for each in bench.values():
        each.place(4.0, 5.5)
        each.run(1.0)
    assert bench[3].goals()[0].pose.y > 6.0
    assert bench[0].goals()[0].pose.y < 5.0


def test_new_goal_without_a_stop_when_the_frontier_has_vanished() -> None:
    bench = Bench(7).map(corridor())
    bench.place(1.0, 0.0)
    bench.run(1.0)
    assert bench.goals()[-1].pose.x > 0
    bench.map(corridor(right=False))
    effects = bench.run(1.0)
    assert [e.pose.x < 0 for e in effects if isinstance(e, SetGoal)] == [True]
    assert not any(isinstance(e, CancelGoal) for e in effects)


def test_visited_frontier_is_no_goal_again() -> None:
    bench = Bench(3).map(corridor(left=False))
    for _ in range(6):
        bench.run(1.0)
        if bench.agent.goal is not None:
            goal = bench.agent.goal
            bench.place(goal.pose.x, goal.pose.y, goal.pose.yaw)
            bench.agent.on_goal_result(goal.goal_id, REACHED, "", bench.now)
        bench.run(1.6)
        bench.map(corridor(left=False))
    assert all(f.visited for f in bench.verdicts())
    assert bench.unreachable() == 0


def test_a_look_waits_for_a_map_of_the_robots_own_slam_that_was_made_after_it() -> None:
    """With a slow SLAM: global maps that come in between show what other robots have seen."""
    bench = Bench(7).map(corridor(left=False))
    bench.run(1.0)
    goal = bench.agent.goal
    assert goal is not None
    bench.place(goal.pose.x, goal.pose.y, goal.pose.yaw)
    bench.run(3.0)
    bench.agent.on_global_map(corridor(left=False), bench.now)
    bench.run(0.4)
    assert {verdict.looks for verdict in bench.verdicts() if verdict.awaits_map(bench.now)} == {1}
    bench.map(corridor(left=False)).map(corridor(left=False))
    bench.run(0.2)
    assert max(verdict.looks for verdict in bench.verdicts()) == 2 and bench.agent.goal is not None


def test_failed_goals_give_a_frontier_up_and_a_changed_map_revives_it() -> None:
    bench = Bench(3, number_unreachable_for_cluster=2).map(corridor(left=False))
    for _ in range(2):
        bench.run(9.0)
        assert bench.agent.goal is not None
        bench.agent.on_goal_result(bench.agent.goal.goal_id, FAILED, "no way", bench.now)
    given_up = [f for f in bench.verdicts() if f.given_up]
    assert given_up and bench.unreachable() == len(given_up)
    occupancy = corridor(left=False)
    occupancy.cells[1:31, 140] = 0
    bench.map(occupancy)
    bench.run(0.4)
    occupancy = corridor(left=False)
    occupancy.cells[1:15, 141:150] = 0
    bench.map(occupancy)
    bench.run(0.4)
    assert not any(f.given_up for f in bench.verdicts())


def fail_behind_a_robot(bench: Bench, times: int) -> None:
    for _ in range(times):
        bench.run(5.0)
        bench.agent.on_positions({"robot_1": (1.0, 0.0)}, bench.now)
        assert bench.agent.goal is not None
        bench.agent.on_goal_result(bench.agent.goal.goal_id, FAILED, "blocked", bench.now)


def test_a_robot_in_the_way_does_not_make_a_frontier_unreachable() -> None:
    bench = Bench(3).map(corridor(left=False)).join("robot_1", position=(1.0, 0.0))
    fail_behind_a_robot(bench, 2)
    assert not any(f.given_up or f.failures for f in bench.verdicts())
    assert bench.agent.state != State.FINISHED


def test_a_robot_that_stays_in_the_way_does_not_keep_the_mission_from_ending() -> None:
    """A robot that had finished in a door kept another one at its frontier behind it for the rest of the mission."""
    bench = Bench(3).map(corridor(left=False)).join("robot_1", position=(1.0, 0.0))
    fail_behind_a_robot(bench, 6)
    assert any(f.given_up for f in bench.verdicts())
    for _ in range(40):
        bench.run(5.0)
        bench.agent.on_positions({"robot_1": (1.0, 0.0)}, bench.now)
        if bench.agent.state == State.FINISHED:
            break
        if bench.agent.goal is not None:
            bench.agent.on_goal_result(bench.agent.goal.goal_id, FAILED, "blocked", bench.now)
    assert bench.agent.state == State.FINISHED


def test_clusters_are_given_up_after_the_parameter() -> None:
    def failures_until_given_up(limit: int) -> int:
        bench = Bench(1, number_unreachable_for_cluster=limit).map(corridor(left=False))
        for count in range(1, 20):
            bench.run(9.0)
            if bench.agent.goal is None:
                return count - 1
            bench.agent.on_goal_result(bench.agent.goal.goal_id, FAILED, "no way", bench.now)
            if all(f.given_up for f in bench.verdicts()):
                return count
        return 99

    assert failures_until_given_up(1) == 1
    assert failures_until_given_up(3) == 3


def test_goal_that_is_not_accepted_is_sent_again() -> None:
    bench = Bench(7, wait_for_planner_result=2).map(corridor())
    bench.agent.tick(bench.now)
    bench.agent.on_pose(bench.pose, bench.now)
    first = [e for e in bench.agent.tick(bench.now) if isinstance(e, SetGoal)]
    later = [e for e in bench.agent.tick(bench.now + 1.9) if isinstance(e, SetGoal)]
    again = [e for e in bench.agent.tick(bench.now + 2.1) if isinstance(e, SetGoal)]
    assert len(first) == 1 and later == [] and len(again) == 1
    assert again[0].goal_id != first[0].goal_id


def test_goals_that_are_never_accepted_fail_in_the_end() -> None:
    """They were sent again for ever: the robot held its cluster and counted no failure."""
    bench = Bench(7, wait_for_planner_result=2, number_unreachable_for_cluster=1).map(corridor(left=False))
    bench.deaf = True
    bench.run(9.8)
    assert len(bench.goals()) == 5 and bench.agent.counters.goals_failed == 0
    bench.run(1.0)
    assert bench.agent.counters.goals_failed == 1 and any(isinstance(e, CancelGoal) for e in bench.effects)
    bench.run(60.0)
    assert bench.agent.state == State.FINISHED


def test_goals_that_are_replaced_before_they_are_accepted_do_not_fail() -> None:
    """A slow move_base accepts each goal, but only when the next one is on its way."""
    bench = Bench(7, wait_for_planner_result=1).map(corridor())
    bench.deaf = True
    for side in range(60):
        bench.map(corridor(left=side % 2 == 0, right=side % 2 == 1))
        bench.run(0.4)
        for goal in bench.goals()[:-1]:
            bench.agent.on_goal_accepted(goal.goal_id, bench.now)
    assert len(bench.goals()) > 40 and bench.agent.counters.goals_failed == 0


def test_no_progress_fails_the_goal() -> None:
    bench = Bench(3, progress_timeout=10.0).map(corridor())
    bench.run(9.0)
    assert bench.agent.counters.goals_failed == 0
    bench.run(2.0)
    assert bench.agent.counters.goals_failed == 1
    assert any(isinstance(e, CancelGoal) for e in bench.effects)


def test_a_goal_that_is_not_reached_in_time_fails_though_the_robot_moves() -> None:
    """It drives to and fro before a door that somebody stands in: 10 s, and 0.2 m/s for the 3 m to the viewpoint."""
    bench = Bench(3, progress_timeout=10.0).map(corridor(left=False))
    for second in range(60):
        bench.place(0.5 + 0.5 * (second // 2 % 2), 0.0)
        bench.run(1.0)
        if bench.agent.counters.goals_failed:
            break
    assert 20.0 < bench.now - 100.0 < 30.0
    assert any("in the time that its way takes" in each.text for each in bench.effects if isinstance(each, Note))


def two_rooms() -> Any:
    """A corridor that is open at its right end; a door on its left leads to a room that is open above and below."""
    cells = np.full((60, 160), -1, dtype=np.int8)
    cells[25:36, 60:150] = 0
    cells[24, 60:150] = cells[36, 60:150] = 100
    cells[0:60, 60] = 100
    cells[26:35, 60] = 0
    cells[5:55, 20:60] = 0
    cells[4:56, 19] = 100
    return map_of(cells, 0.1)


def test_what_lies_behind_the_same_block_fails_with_the_goal() -> None:
    """A robot has died in the door: one try after the other, for each frontier behind it, would take many minutes."""
    bench = Bench(0).map(two_rooms())
    bench.place(8.0, 3.0)
    bench.run(1.0)
    bench.place(6.8, 3.0)
    bench.run(1.0)
    for _ in range(2):
        while bench.agent.goal is None or bench.agent.goal.pose.x > 6.0:
            bench.run(1.0)
        bench.agent.on_goal_result(bench.agent.goal.goal_id, FAILED, "blocked", bench.now)
    states = {(verdict.x < 6.0, verdict.y < 3.0): verdict.given_up for verdict in bench.verdicts()}
    assert states[(True, True)] and states[(True, False)]
    assert not any(verdict.given_up for verdict in bench.verdicts() if verdict.x > 10.0)


def test_results_of_former_goals_and_of_others_are_harmless() -> None:
    bench = Bench(3).map(corridor())
    bench.run(1.0)
    assert bench.agent.goal is not None
    bench.agent.on_goal_result(bench.agent.goal.goal_id - 1, FAILED, "old", bench.now)
    assert bench.agent.goal is not None
    bench.agent.on_goal_result(bench.agent.goal.goal_id, REPLACED, "by hand", bench.now)
    assert not [e for e in bench.run(1.5) if isinstance(e, SetGoal)]
    assert [e for e in bench.run(2.0) if isinstance(e, SetGoal)]
    assert bench.agent.counters.goals_failed == 0


def test_bad_poses_are_ignored() -> None:
    bench = Bench(3).map(corridor())
    bench.run(1.0)
    for pose in (Pose(float("nan"), 0.0, 0.0), Pose(0.0, 1e308, 0.0), Pose(0.0, 0.0, float("inf"))):
        bench.agent.on_pose(pose, bench.now)
        assert bench.agent.pose == bench.pose


# ---- the end --------------------------------------------------------------------------------------------------------


def closed() -> Any:
    return corridor(left=False, right=False)


def test_one_empty_list_is_not_the_end() -> None:
    bench = Bench(7).map(corridor())
    bench.run(1.0)
    bench.map(closed())
    bench.run(1.0)
    assert bench.agent.finished_at is None
    bench.map(corridor(left=False))
    bench.run(10.0)
    assert bench.agent.finished_at is None and bench.agent.goal is not None


def test_finishes_once_after_the_delay_and_goes_home() -> None:
    bench = Bench(7, finish_delay=3.0, log_path="/somewhere").map(corridor())
    bench.run(1.0)
    bench.place(3.0, 0.0)
    bench.run(0.4)
    bench.map(closed())
    bench.run(2.6)
    assert bench.agent.finished_at is None
    bench.map(closed())
    effects = bench.run(1.0)
    assert bench.agent.state == State.RETURNING
    time = bench.agent.exploration_time(bench.now)
    assert effects.count(LogOutput(3)) == 1
    log = next(e for e in effects if isinstance(e, WriteLog) and e.name == "exploration.log")
    assert f"exploration_time={time:.3f}" in log.text and "complete=1" in log.text
    home = [e for e in effects if isinstance(e, SetGoal)][-1]
    assert (home.pose.x, home.pose.y) == (0.5, 0.0)
    bench.map(corridor())
    bench.place(0.5, 0.0)
    bench.run(3.0)
    assert bench.agent.state == State.FINISHED
    assert bench.agent.exploration_time(bench.now) == time


def test_the_map_must_be_younger_than_the_last_motion() -> None:
    bench = Bench(7, finish_delay=1.0).map(closed())
    bench.run(0.4)
    bench.place(1.0, 0.0)
    bench.run(3.0)
    assert bench.agent.finished_at is None, "the map is older than the motion"
    bench.agent.on_global_map(closed(), bench.now)
    bench.run(0.4)
    assert bench.agent.finished_at is None, "the robot's own map is older than the motion"
    bench.agent.on_own_map(bench.now)
    bench.run(0.4)
    assert bench.agent.finished_at is not None


def test_a_map_that_no_longer_changes_ends_it_too() -> None:
    bench = Bench(7, finish_delay=1.0)
    bench.map(closed())
    bench.place(1.0, 0.0)
    bench.run(7.0)
    assert bench.agent.finished_at is not None


def test_given_up_frontiers_get_a_last_try_before_the_end() -> None:
    bench = Bench(3, number_unreachable_for_cluster=1).map(corridor(left=False))
    bench.run(1.0)
    tries = 0
    for _ in range(200):
        bench.run(1.0)
        if bench.agent.finished_at is not None:
            break
        if bench.agent.goal is not None:
            tries += 1
            bench.agent.on_goal_result(bench.agent.goal.goal_id, FAILED, "no way", bench.now)
    assert bench.agent.finished_at is not None
    assert tries >= 2


def test_home_is_tried_five_times() -> None:
    bench = Bench(7, home_pose=(3.0, 0.0, 0.0)).map(closed())
    bench.run(7.0)
    assert bench.agent.state == State.RETURNING
    for _ in range(40):
        if bench.agent.goal is not None:
            bench.agent.on_goal_result(bench.agent.goal.goal_id, FAILED, "no way", bench.now)
        bench.run(1.0)
    assert len(bench.goals()) == 5
    assert bench.agent.state == State.FINISHED and "away from home" in bench.agent.text


@pytest.mark.parametrize("called, state", [(False, State.FINISHED), (True, State.WAITING)])
def test_a_robot_at_home_drives_aside_for_another_one_and_back(called: bool, state: State) -> None:
    """Mates that had come home first, after the end or called back, stood in the way of those who live behind them."""
    bench = Bench(7).map(closed())
    bench.agent.on_robots(["robot_1"], bench.now)
    bench.agent.on_transform("robot_1", np.array([[1.0, 0.0, -1.5], [0.0, 1.0, 0.0]]), bench.now)
    bench.run(0.4)
    if called:
        bench.agent.return_now(bench.now)
    bench.run(8.0)
    assert bench.agent.state == state and not bench.goals()
    for _ in range(12):
        bench.agent.on_positions({"robot_1": (2.0, 0.0)}, bench.now)
        bench.run(1.0)
    assert bench.agent.state == State.RETURNING and "makes room for robot_1" in bench.agent.text
    aside = bench.goals()[-1].pose
    assert abs(aside.y) > 0.7 and abs(aside.x - 0.5) < 0.2, "beside its home, out of the middle of the corridor"
    bench.place(aside.x, aside.y)
    bench.agent.on_positions({"robot_1": (-1.4, 0.0)}, bench.now)
    bench.run(2.0)
    home = bench.goals()[-1].pose
    assert (home.x, home.y) == (0.5, 0.0)
    bench.place(0.5, 0.0)
    bench.run(1.0)
    assert bench.agent.state == state and "at home" in bench.agent.text


@pytest.mark.parametrize("log_path, masks", [("", []), ("/somewhere", [12, 3])])
def test_maps_are_logged_only_where_logs_are_written(log_path: str, masks: List[int]) -> None:
    """Without a log path map_merger refused the call, and the node warned of it every 30 s."""
    bench = Bench(7, log_path=log_path).map(corridor())
    bench.run(10.4)
    bench.map(closed())
    bench.run(8.0)
    assert bench.agent.finished_at is not None
    assert [effect.mask for effect in bench.effects if isinstance(effect, LogOutput)] == masks


def test_home_is_tried_five_times_when_no_goal_is_accepted() -> None:
    """The way home never ended: the state stayed RETURNING."""
    bench = Bench(7, home_pose=(3.0, 0.0, 0.0), wait_for_planner_result=1).map(closed())
    bench.deaf = True
    bench.run(7.0)
    assert bench.agent.state == State.RETURNING
    bench.run(60.0)
    assert bench.agent.state == State.FINISHED and "away from home" in bench.agent.text
    assert len(bench.goals()) == 5 * 5


def test_stays_where_it_is_if_so_wished() -> None:
    bench = Bench(7, return_home=False).map(closed())
    bench.place(3.0, 0.0)
    bench.run(10.0)
    assert bench.agent.state == State.FINISHED and not bench.goals()


@pytest.mark.parametrize("strategy", [1, 5, 7])
@pytest.mark.parametrize("back_to", [1.0, 150.0], ids=["before the start", "after the start"])
def test_a_clock_that_is_set_back_starts_the_mission_anew(strategy: int, back_to: float) -> None:
    """Only the start was noted anew: sharing, auctions, logs and the end waited until the old time had come again."""
    bench = Bench(strategy, log_path="/somewhere").map(corridor()).join("robot_1", position=(-3.0, 0.0))
    for _ in range(100):
        bench.run(1.0)
        bench.agent.on_positions({"robot_1": (-3.0, 0.0)}, bench.now)
    sent = [e for e in bench.effects if isinstance(e, SendFrontiers) and e.topic == "frontiers"]
    assert bench.now > 199.0
    bench.now = back_to
    bench.effects.clear()
    bench.run(12.0)
    assert 11.0 <= bench.agent.exploration_time(bench.now) <= 12.0
    kinds = [type(effect) for effect in bench.effects]
    assert kinds.index(CancelGoal) < kinds.index(SetGoal), "the old goal is given up, there is a new one"
    assert WriteLog in kinds and LogOutput(12) in bench.effects
    assert any(auction.start for auction in bench.auctions()) == (strategy != 5)
    shared = {e.topic: e.elements for e in bench.effects if isinstance(e, SendFrontiers)}
    old = {element.number for message in sent for element in message.elements}
    assert {element.number for element in shared["visited_frontiers"]} == old, "the others forget the old points"
    assert not old & {element.number for element in shared["frontiers"]}
    bench.map(closed())
    bench.run(8.0)
    assert bench.agent.finished_at is not None


def test_a_finished_mission_starts_anew_when_the_clock_is_set_back() -> None:
    bench = Bench(7).map(closed())
    bench.run(8.0)
    assert bench.agent.state == State.FINISHED
    bench.now = 1.0
    bench.map(corridor())
    bench.run(1.0)
    assert bench.agent.finished_at is None and bench.agent.state == State.EXPLORING and bench.goals()


def test_claims_of_the_time_before_a_clock_was_set_back_do_not_hold() -> None:
    bench = claimed_right(7)
    bench.run(1.0)
    assert not bench.goals()
    bench.now = 1.0
    bench.run(1.5)
    assert bench.goals()


def test_a_clock_that_is_set_back_a_little_changes_nothing() -> None:
    bench = Bench(7).map(corridor())
    bench.run(5.0)
    bench.now -= 0.9
    bench.run(5.0)
    assert 9.0 <= bench.agent.exploration_time(bench.now) <= 9.2
    assert not complaints(bench) and len(bench.goals()) == 1


# ---- auctions -------------------------------------------------------------------------------------------------------


def opened(strategy: int = 1, peers: tuple = ("robot_1",), position: Optional[tuple] = (-3.0, 0.0)) -> Any:
    bench = Bench(strategy, auction_timeout=1.0).map(corridor())
    bench.join(*peers, position=position)
    bench.run(0.2)
    start = next(a for a in bench.auctions() if a.start)
    return bench, start


def chosen_side(bench: Bench) -> float:
    return float(np.sign(bench.goals()[-1].pose.x))


def test_start_message_has_the_flags_of_the_contract() -> None:
    bench, start = opened()
    assert (start.status, start.start, start.finished, start.occupied) == (True, True, False, ())
    assert len(start.requested) == 2
    shared = [e for e in bench.effects if isinstance(e, SendFrontiers) and e.topic == "frontiers"]
    keys = {e.key for message in shared for e in message.elements}
    assert {key for offer in start.requested for key in offer.elements} <= keys


def test_closes_as_soon_as_all_have_answered() -> None:
    bench, start = opened(peers=("robot_1", "robot_2"))
    bench.agent.on_auction(reply(start, "robot_1", [1.0, 99.0]), bench.now)
    assert not [a for a in (e.auction for e in bench.tick() if isinstance(e, SendAuction)) if a.finished]
    bench.agent.on_auction(reply(start, "robot_2", [99.0, 98.0]), bench.now)
    closing = [e.auction for e in bench.tick() if isinstance(e, SendAuction)][-1]
    assert (closing.status, closing.start, closing.finished, closing.requested) == (True, False, True, ())
    assert closing.auction_id == start.auction_id and closing.occupied
    assert bench.agent.counters.auctions_completed == 1


def test_only_auction_messages_that_lead_to_something_ask_for_a_step_at_once() -> None:
    """Each bid in each auction woke each robot of a team: sixteen decided two hundred times a second."""
    bench, start = opened(peers=("robot_1", "robot_2"))
    take = bench.agent.on_auction
    assert not take(Auction("robot_2", 99, status=False, available=(Bid((("robot_1", 1),), 1.0),)), bench.now)
    assert not take(reply(start, "robot_1", [1.0, 99.0]), bench.now)
    assert take(reply(start, "robot_2", [99.0, 98.0]), bench.now)
    assert not take(reply(start, "robot_2", [99.0, 98.0]), bench.now)
    assert take(Auction("robot_1", 5, True, start=True), bench.now)
    assert take(Auction("robot_1", 5, True, finished=True), bench.now)


def test_deadline_and_robots_that_do_not_answer() -> None:
    bench, _ = opened()
    bench.run(0.8)
    assert not bench.goals()
    bench.run(0.4)
    assert bench.goals() and bench.agent.counters.auctions_uncompleted == 1
    peer = bench.agent.mission.team.peer("robot_1")
    assert peer is not None and peer.unanswered == 1
    peer.unanswered = 2
    assert bench.agent.mission.team.bidders() == set()
    bench.agent.on_auction(Auction("robot_1", 5, status=False), bench.now)
    assert bench.agent.mission.team.bidders() == {"robot_1"}


def side_of(start: Auction, bench: Bench, side: float) -> int:
    """Row of the cluster on that side in the start message."""
    for row, offer in enumerate(start.requested):
        frontier = bench.agent.perception.frontiers.frontiers[offer.elements[0][1]]
        if np.sign(frontier.x) == side:
            return row
    raise AssertionError("no cluster there")


@pytest.mark.parametrize("strategy", [1, 7])
def test_dropping_one_bid_changes_the_result(strategy: int) -> None:
    """The other robot bids little for the right and much for the left. Without its bids its position, on the left,
    says the opposite."""

    def outcome(drop: bool) -> float:
        bench, start = opened(strategy)
        bids = [0.0, 0.0]
        bids[side_of(start, bench, 1.0)], bids[side_of(start, bench, -1.0)] = 0.5, 900.0
        if not drop:
            bench.agent.on_auction(reply(start, "robot_1", bids), bench.now)
        bench.run(1.4)
        return chosen_side(bench)

    assert outcome(drop=False) == -1.0
    assert outcome(drop=True) == 1.0


@pytest.mark.parametrize("strategy", [1, 7])
def test_bids_in_another_unit_are_an_answer_and_no_more(strategy: int) -> None:
    """Squared metres and metres were compared: the robot is judged by its place, and not waited for."""
    bench, start = opened(strategy)
    bids = [0.0, 0.0]
    bids[side_of(start, bench, 1.0)], bids[side_of(start, bench, -1.0)] = 0.5, 900.0
    other = replace(reply(start, "robot_1", bids), unit={1: 7, 7: 1}[strategy])
    assert start.unit == strategy
    bench.agent.on_auction(other, bench.now)
    bench.run(0.2)
    assert chosen_side(bench) == 1.0 and bench.auctions()[-1].finished
    assert bench.agent.counters.auctions_completed == 0
    peer = bench.agent.mission.team.peer("robot_1")
    assert peer is not None and peer.unanswered == 0


def test_answers_tell_the_unit_of_their_bids() -> None:
    for strategy in range(8):
        bench = Bench(strategy).map(corridor()).join("robot_1")
        bench.run(0.2)
        bench.agent.on_frontiers([Element("robot_1", 10000, 4.0, 0.0)], bench.now)
        offer = Bid((("robot_1", 10000),))
        bench.agent.on_auction(Auction("robot_1", 10001, True, start=True, requested=(offer,)), bench.now)
        bench.tick()
        (answer,) = [auction for auction in bench.auctions() if not auction.status]
        assert answer.unit == (7 if strategy == 7 else 1)


def test_cluster_that_another_robot_does_not_know_is_not_left_to_it() -> None:
    """Both others stand on the left, but neither has a bid there; one of them bids less for the right."""
    bench, start = opened(7, peers=("robot_1", "robot_2"))
    for robot, bid in (("robot_1", 0.5), ("robot_2", 30.0)):
        bids = [-1.0, -1.0]
        bids[side_of(start, bench, 1.0)] = bid
        bench.agent.on_auction(reply(start, robot, bids), bench.now)
    bench.run(1.0)
    assert chosen_side(bench) == -1.0


def test_silent_robot_without_a_position_does_not_count() -> None:
    bench, _ = opened(1, position=None)
    bench.run(1.4)
    assert chosen_side(bench) == 1.0


def test_duplicates_strays_and_late_bids_are_ignored() -> None:
    bench, start = opened(peers=("robot_1", "robot_2"))
    row = side_of(start, bench, 1.0)
    good = [900.0, 900.0]
    good[row] = 0.5
    first = reply(start, "robot_1", good)
    worse = reply(start, "robot_1", good[::-1])
    stray = Auction("robot_2", start.auction_id + 77, status=False, available=first.available)
    foreign = Auction("robot_2", start.auction_id, status=False, available=(Bid((("robot_9", 1),), 1.0),))
    for message in (stray, first, worse, first, foreign, stray):
        bench.agent.on_auction(message, bench.now)
    bench.run(0.4)
    assert chosen_side(bench) == -1.0
    goals = len(bench.goals())
    bench.agent.on_auction(worse, bench.now)
    bench.run(0.4)
    assert len(bench.goals()) == goals


def test_bids_for_the_other_robots_clusters() -> None:
    bench = Bench(1).map(corridor()).join("robot_1", position=(-3.0, 0.0))
    bench.run(0.2)
    elements = tuple(Element("robot_1", 10000 + i, 3.9, -1.0 + 0.2 * i) for i in range(11))
    bench.agent.on_frontiers(elements, bench.now)
    offer = Bid(tuple(e.key for e in elements))
    unknown = Bid((("robot_1", 4711),))
    bench.agent.on_auction(Auction("robot_1", 10001, True, start=True, requested=(offer, unknown)), bench.now)
    answer = next(a for a in (e.auction for e in bench.tick() if isinstance(e, SendAuction)) if not a.status)
    assert (answer.auction_id, answer.robot) == (10001, "robot_0")
    assert [bid.elements for bid in answer.available] == [offer.elements, unknown.elements]
    assert answer.available[0].bid == float(int(3.4**2)), "from x = 0.5 m to 3.9 m"
    assert answer.available[1].bid == -1.0


def test_bids_between_a_new_map_and_the_next_step_go_by_the_map_that_was_perceived() -> None:
    """Tours were measured on the new map, clusters on the one before: the bids were of neither."""

    def bids(walled: bool) -> List[float]:
        occupancy, closed_off = corridor(), corridor()
        for each in (occupancy, closed_off):
            each.cells[12:20, 75:83] = -1
        closed_off.cells[:, 100] = 100
        bench = Bench(7).map(occupancy).join("robot_1", position=(-3.0, 0.0))
        bench.run(2.0)
        bench.map(occupancy)
        bench.tick()
        if walled:
            bench.map(closed_off)
        clusters = bench.agent.perception.clusters
        offers = tuple(Bid(tuple(("robot_0", number) for number in cluster.numbers)) for cluster in clusters)
        bench.agent.on_auction(Auction("robot_1", 10001, True, start=True, requested=offers), bench.now)
        answer = next(a for a in (e.auction for e in bench.tick() if isinstance(e, SendAuction)) if not a.status)
        return [bid.bid for bid in answer.available]

    assert min(bids(False)) > 0.0
    assert bids(True) == bids(False)


def test_a_look_between_a_larger_map_and_the_next_step_goes_by_the_map_that_was_perceived() -> None:
    """Cells of the new map were looked up in the one before, so what the robot saw counted as hidden."""
    bench = Bench(3).map(corridor(left=False))
    bench.run(1.0)
    goal = bench.agent.goal
    assert goal is not None
    bench.place(goal.pose.x, goal.pose.y, goal.pose.yaw)
    known = corridor(left=False)
    grown = np.full((132, 302), -1, dtype=np.int8)
    grown[100:, 100:] = known.cells
    bench.map(map_of(grown, 0.1, x=-20.0, y=-11.6))
    bench.agent.on_goal_result(goal.goal_id, REACHED, "", bench.now)
    looked = sum(verdict.looks for verdict in bench.verdicts())
    assert looked > 1, "the goal's frontier and those beside it"


def test_without_a_transform_the_answer_is_empty_and_the_robot_is_not_counted() -> None:
    bench = Bench(1).map(corridor())
    bench.agent.on_robots(["robot_1"], bench.now)
    bench.run(0.2)
    start = next(a for a in bench.auctions() if a.start)
    bench.agent.on_auction(Auction("robot_1", 10001, True, start=True, requested=(Bid((("robot_1", 1),)),)), bench.now)
    answer = next(a for a in (e.auction for e in bench.tick() if isinstance(e, SendAuction)) if not a.status)
    assert answer.available == ()
    bench.agent.on_auction(Auction("robot_1", start.auction_id, status=False), bench.now)
    bench.run(0.4)
    assert chosen_side(bench) == 1.0


def claimed_right(strategy: int) -> Bench:
    bench = Bench(strategy, claim_timeout=20.0).map(corridor(left=False)).join("robot_1", position=(3.0, 0.0))
    elements = tuple(Element("robot_1", 10000 + i, 3.9, -1.2 + 0.2 * i) for i in range(13))
    bench.agent.on_frontiers(elements, bench.now)
    confirm_right(bench)
    return bench


def confirm_right(bench: Bench) -> None:
    occupied = tuple(("robot_1", 10000 + i) for i in range(13))
    bench.agent.on_auction(Auction("robot_1", 10001, True, finished=True, occupied=occupied), bench.now)


def test_the_cluster_of_a_robot_that_died_is_free_within_ten_seconds() -> None:
    """It was its own until `claim_timeout`, 30 s."""
    bench = claimed_right(7)
    bench.run(6.0)
    assert not bench.goals()
    bench.run(4.0)
    assert bench.goals()


@pytest.mark.parametrize("strategy", [1, 7])
def test_a_claimed_cluster_is_left_alone_and_released(strategy: int) -> None:
    for release in ("timeout", "left", "moved on"):
        bench = claimed_right(strategy)
        bench.run(6.0)
        assert not bench.goals(), "claimed by robot_1"
        assert bench.agent.state == State.WAITING
        if release == "left":
            bench.agent.on_robots([], bench.now)
        elif release == "moved on":
            bench.agent.on_auction(Auction("robot_1", 10002, True, finished=True), bench.now)
            bench.agent.on_positions({"robot_1": (-8.0, 0.0)}, bench.now)
        else:
            bench.run(16.0)
        bench.run(7.0)
        assert bench.goals(), release


@pytest.mark.parametrize("place, takes", [(-3.0, True), (3.0, False)])
def test_a_robot_that_waits_nearer_than_the_one_that_claims_takes_the_cluster(place: float, takes: bool) -> None:
    """Seed 512 of the office with four robots: one waited in a door, in the way of those that claimed what was behind,
    for 750 s."""
    bench = claimed_right(7)
    for _ in range(5):
        bench.agent.on_positions({"robot_1": (place, 0.0)}, bench.now)
        confirm_right(bench)
        bench.run(2.0)
    assert not bench.goals(), "not at once"
    for _ in range(3):
        bench.agent.on_positions({"robot_1": (place, 0.0)}, bench.now)
        confirm_right(bench)
        bench.run(2.0)
    assert bool(bench.goals()) == takes


@pytest.mark.parametrize("strategy", [1, 7])
def test_no_auction_after_auction_while_all_clusters_are_claimed(strategy: int) -> None:
    """An idle robot flooded the air: answers at once closed its auction, and in the same moment it opened the next."""
    bench = claimed_right(strategy)
    answered = set()
    for _ in range(200):
        for auction in [a for a in bench.auctions() if a.start and a.auction_id not in answered]:
            answered.add(auction.auction_id)
            bench.agent.on_auction(reply(auction, "robot_1", [0.5] * len(auction.requested)), bench.now)
        bench.run(0.02, step=0.02)
    assert not bench.goals() and 2 <= len(answered) <= 5, "four seconds, one auction each second"


def test_two_robots_that_chose_the_same_cluster_settle_it() -> None:
    """The lower bid keeps it; with equal bids the lesser name."""
    for bid, keeps in ((0.0, False), (500.0, True)):
        bench = Bench(1).map(corridor()).join("robot_1", position=(0.4, 0.0))
        bench.run(0.2)
        start = next(a for a in bench.auctions() if a.start)
        bench.agent.on_auction(reply(start, "robot_1", [900.0, 900.0]), bench.now)
        bench.run(0.4)
        side = chosen_side(bench)
        elements = tuple(Element("robot_1", 10000 + i, 3.9 * side, -1.2 + 0.2 * i) for i in range(13))
        keys = tuple(e.key for e in elements)
        bench.agent.on_frontiers(elements, bench.now)
        bench.agent.on_auction(Auction("robot_1", 10001, True, start=True, requested=(Bid(keys, bid),)), bench.now)
        bench.agent.on_auction(Auction("robot_1", 10001, True, finished=True, occupied=keys), bench.now)
        assert (bench.agent.mission.claim.number is not None) == keeps


@pytest.mark.parametrize("told, keeps", [(5.0, False), (500.0, True)])
def test_a_tie_is_settled_by_what_both_were_told(told: float, keeps: bool) -> None:
    """Each compared its bid of now, from nearer by, with what the other had bid when it asked: both kept it."""
    bench = Bench(1).map(corridor()).join("robot_1", position=(0.4, 0.0))
    bench.run(0.2)
    start = next(a for a in bench.auctions() if a.start)
    bench.agent.on_auction(reply(start, "robot_1", [900.0, 900.0]), bench.now)
    bench.run(0.4)
    side = chosen_side(bench)
    assert min(bid.bid for bid in start.requested) > 5.0
    bench.place(3.5 * side, 0.0)
    elements = tuple(Element("robot_1", 10000 + i, 3.9 * side, -1.2 + 0.2 * i) for i in range(13))
    keys = tuple(e.key for e in elements)
    bench.agent.on_frontiers(elements, bench.now)
    bench.agent.on_auction(Auction("robot_1", 10001, True, start=True, requested=(Bid(keys, told),)), bench.now)
    bench.agent.on_auction(Auction("robot_1", 10001, True, finished=True, occupied=keys), bench.now)
    assert (bench.agent.mission.claim.number is not None) == keeps


def test_a_tie_is_not_settled_by_a_bid_in_another_unit() -> None:
    """A bid of 500 in another unit is no reason to keep the cluster: the other robot stands in it."""
    bench = Bench(1).map(corridor()).join("robot_1", position=(0.4, 0.0))
    bench.run(0.2)
    start = next(a for a in bench.auctions() if a.start)
    bench.agent.on_auction(reply(start, "robot_1", [900.0, 900.0]), bench.now)
    bench.run(0.4)
    side = chosen_side(bench)
    bench.agent.on_positions({"robot_1": (3.8 * side, 0.0)}, bench.now)
    elements = tuple(Element("robot_1", 10000 + i, 3.9 * side, -1.2 + 0.2 * i) for i in range(13))
    keys = tuple(e.key for e in elements)
    bench.agent.on_frontiers(elements, bench.now)
    offer = Auction("robot_1", 10001, True, start=True, requested=(Bid(keys, 500.0),), unit=7)
    bench.agent.on_auction(offer, bench.now)
    bench.agent.on_auction(Auction("robot_1", 10001, True, finished=True, occupied=keys), bench.now)
    assert bench.agent.mission.claim.number is None


def test_forged_and_huge_messages_are_bounded() -> None:
    bench = Bench(7).map(corridor())
    for number in range(300):
        bench.agent.on_auction(Auction(f"robot_{number + 1}", 1, True, start=True), bench.now)
        bench.agent.on_frontiers([Element(f"ghost_{number}", 1, float("nan"), 0.0)], bench.now)
    bench.agent.on_auction(Auction("robot_0", 1, True, finished=True, occupied=(("robot_0", 0),)), bench.now)
    bench.run(1.0)
    assert len(bench.agent.mission.team.known()) <= 100
    assert bench.agent.foreign.count() == 0


IMPOSSIBLE = [1e308, -1.7e308, 3e5, float("inf"), float("nan")]


def complaints(bench: Bench) -> List[str]:
    return [effect.text for effect in bench.effects if isinstance(effect, Note) and effect.warning]


@pytest.mark.parametrize("value", IMPOSSIBLE)
def test_positions_that_cannot_be_do_not_end_the_node(value: float) -> None:
    """Finite but huge ones ended it: they have no cell."""
    bench = Bench(7).map(corridor()).join("robot_1", "robot_2", position=(-3.0, 0.0))
    for _ in range(20):
        bench.agent.on_positions({"robot_1": (value, 0.0), "robot_2": (0.5, -value)}, bench.now)
        bench.map(corridor())
        bench.run(0.4)
    assert bench.goals() and bench.agent.mission.team.positions(bench.now)["robot_1"] == (-3.0, 0.0)
    assert len(complaints(bench)) == 1 and "robot_1, robot_2" in complaints(bench)[0]


@pytest.mark.parametrize("value", IMPOSSIBLE)
@pytest.mark.parametrize("strategy", [1, 5, 7])
def test_frontiers_and_transforms_that_cannot_be_do_not_end_the_node(strategy: int, value: float) -> None:
    bench = Bench(strategy).map(corridor()).join("robot_1", "robot_2", position=(-3.0, 0.0))
    bench.agent.on_transform("robot_2", np.array([[1.0, 0.0, value], [0.0, 1.0, 0.0]]), bench.now)
    for robot, x in (("robot_1", value), ("robot_2", 3.9)):
        elements = [Element(robot, number, x, 0.1 * number) for number in range(5)]
        claim = Auction(robot, 10001, True, finished=True, occupied=tuple(e.key for e in elements))
        bench.agent.on_frontiers(elements, bench.now)
        bench.agent.on_visited_frontiers(elements[:1], bench.now)
        bench.agent.on_negotiation_list(elements, bench.now)
        bench.agent.on_auction(claim, bench.now)
    bench.run(2.0)
    assert bench.goals() and len(complaints(bench)) == 2


@pytest.mark.parametrize("value", IMPOSSIBLE)
def test_bids_that_cannot_be_do_not_end_the_node(value: float) -> None:
    bench, start = opened(7)
    bench.agent.on_auction(reply(start, "robot_1", [value, 1.0]), bench.now)
    bench.run(2.0)
    assert bench.goals()


def test_only_new_frontiers_are_sent() -> None:
    bench = Bench(7).map(corridor()).join("robot_1", position=(-3.0, 0.0))
    bench.run(10.0)
    sent = [e for e in bench.effects if isinstance(e, SendFrontiers) and e.topic == "frontiers"]
    assert len(sent) == 1
    bench.map(corridor(right=False))
    bench.run(2.0)
    gone = [e for e in bench.effects if isinstance(e, SendFrontiers) and e.topic == "visited_frontiers"]
    assert len(gone) == 1 and all(e.x > 0 for e in gone[0].elements)
    bench.join("robot_1", "robot_2", position=(-3.0, 0.0))
    bench.run(2.0)
    again = [e for e in bench.effects if isinstance(e, SendFrontiers) and e.topic == "frontiers"]
    assert len(again) == 2, "a new robot gets all"


def test_what_another_robot_explored_is_no_goal_until_the_map_shows_it() -> None:
    bench = Bench(3).map(corridor(left=False)).join("robot_1", position=(-3.0, 0.0))
    bench.agent.on_visited_frontiers([Element("robot_1", i, 3.9, -1.4 + 0.3 * i) for i in range(11)], bench.now)
    bench.run(4.0)
    assert not bench.goals() and bench.agent.finished_at is None
    bench.run(6.0)
    assert bench.goals(), "the map still shows it: it is a frontier"


def test_what_was_explored_far_from_all_goals_is_no_reason_to_look_anew() -> None:
    """Sixteen robots looked at all their frontiers again six times a second."""
    bench = Bench(3).map(corridor(left=False)).join("robot_1", position=(-3.0, 0.0))
    bench.run(1.0)
    perception = bench.agent.perception
    perceived = perception.revision
    bench.agent.on_visited_frontiers([Element("robot_1", 1, -3.0, 0.0)], bench.now)
    bench.run(0.2)
    assert perception.revision == perceived
    bench.agent.on_visited_frontiers([Element("robot_1", 2, 3.9, 0.0)], bench.now)
    bench.run(0.2)
    assert perception.revision == perceived + 1


def test_negotiated_clusters_are_left_to_the_other() -> None:
    bench = Bench(5).map(corridor()).join("robot_1", position=(3.0, 0.0))
    bench.agent.on_negotiation_list([Element("robot_1", 10000 + i, 3.9, -1.2 + 0.2 * i) for i in range(13)], bench.now)
    bench.run(1.0)
    assert chosen_side(bench) == -1.0
    chosen = [e for e in bench.effects if isinstance(e, SendFrontiers) and e.topic == "negotiation_list"]
    assert len(chosen) == 1 and all(e.x < 0 for e in chosen[0].elements)


def test_a_negotiated_cluster_stays_with_the_robot_that_explores_it() -> None:
    """The choice was told once: after `claim_timeout` another robot took the cluster while the first was in it."""
    first = Bench(5, progress_timeout=1000.0).map(corridor(left=False)).join("robot_1", position=(-3.0, 0.0))
    first.run(1.0)
    second = Bench(5, "robot_1", claim_timeout=30.0).map(corridor(left=False)).join("robot_0", position=(0.5, 0.0))
    told = 0
    for _ in range(120):
        lists = [e for e in first.effects if isinstance(e, SendFrontiers) and e.topic == "negotiation_list"]
        for message in lists[told:]:
            second.agent.on_negotiation_list(message.elements, second.now)
        told = len(lists)
        first.run(1.0)
        second.run(1.0)
    assert first.goals() and not second.goals()
    assert told <= 120 / 8 + 2, "confirmed now and then, not all the time"


def test_a_negotiated_cluster_that_was_given_up_is_no_longer_claimed() -> None:
    bench = Bench(5, number_unreachable_for_cluster=1, finish_delay=600.0)
    bench.map(corridor(left=False)).join("robot_1", position=(-3.0, 0.0))
    bench.run(1.0)
    assert bench.agent.goal is not None
    bench.agent.on_goal_result(bench.agent.goal.goal_id, FAILED, "no way", bench.now)
    bench.run(2.0)
    lists = [e for e in bench.run(20.0) if isinstance(e, SendFrontiers) and e.topic == "negotiation_list"]
    assert bench.unreachable() > 0 and not lists


def test_traces_of_a_robot_in_the_only_door_do_not_end_the_mission() -> None:
    """The door of the room has traces of another robot in the map; a look at it clears them."""
    cells = np.full((60, 120), -1, dtype=np.int8)
    cells[5:55, 5:60] = 0
    cells[5:55, [4, 40]] = cells[[4, 55], 4:60] = 100
    cells[25:35, 40] = 0
    free = map_of(cells, 0.1)
    blocked = map_of(cells.copy(), 0.1)
    blocked.cells[28:32, 42:44] = 100
    bench = Bench(7)
    bench.place(2.0, 3.0)
    bench.map(blocked)
    bench.run(8.0)
    look = bench.goals()[-1].pose
    assert bench.agent.finished_at is None and look.x > 3.0 and abs(look.yaw) < 0.5
    bench.place(look.x, look.y, look.yaw)
    assert bench.agent.goal is not None
    bench.agent.on_goal_result(bench.agent.goal.goal_id, REACHED, "", bench.now)
    bench.map(free)
    bench.run(2.0)
    assert bench.goals()[-1].pose.x > 4.5 and bench.agent.state == State.EXPLORING


def test_closer_looks_are_bounded() -> None:
    cells = np.full((60, 120), -1, dtype=np.int8)
    cells[5:55, 5:60] = 0
    cells[5:55, [4, 40]] = cells[[4, 55], 4:60] = 100
    cells[29:31, 40] = 0
    bench = Bench(7)
    bench.place(2.0, 3.0)
    bench.map(map_of(cells, 0.1))
    for _ in range(60):
        bench.run(1.0)
        if bench.agent.goal is not None and bench.agent.finished_at is None:
            bench.agent.on_goal_result(bench.agent.goal.goal_id, FAILED, "no way", bench.now)
    assert bench.agent.finished_at is not None and 1 <= len(bench.agent.mission.ending.closer_looks) <= 20


def test_frontier_that_no_look_changes_does_not_hold_the_robot_for_ever() -> None:
    """Behind a robot that died: its goals are reached at once where the robot stands, and no new map comes."""
    bench = Bench(7).map(corridor(left=False))
    bench.run(1.0)
    for _ in range(150):
        goal = bench.agent.goal
        if goal is not None and bench.agent.finished_at is None:
            bench.place(goal.pose.x, goal.pose.y, goal.pose.yaw)
            bench.agent.on_goal_result(goal.goal_id, REACHED, "", bench.now)
        bench.run(0.4)
    assert bench.agent.finished_at is not None


def test_costs_for_the_robots_of_a_large_team_are_computed_once_for_a_map(monkeypatch: pytest.MonkeyPatch) -> None:
    places = {f"robot_{i}": (-3.0 + 0.5 * i, 0.5) for i in range(1, 13)}
    computed: List[tuple] = []
    field_from = TravelGrid.field_from

    def counted(grid: TravelGrid, x: float, y: float, *former: Any) -> Any:
        if (x, y) in places.values():
            computed.append((x, y))
        return field_from(grid, x, y, *former)

    monkeypatch.setattr(TravelGrid, "field_from", counted)
    bench = Bench(7, auction_timeout=1.0).map(corridor())
    bench.join(*places, position=(0.0, 0.0))
    for _ in range(20):
        bench.agent.on_positions(places, bench.now)
        bench.run(1.0)
    assert sum(auction.start for auction in bench.auctions()) >= 2
    assert sorted(computed) == sorted(places.values())
