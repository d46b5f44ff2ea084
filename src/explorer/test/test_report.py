"""What a robot tells of itself: reasons, bids, assignment, forecast, leftovers, the team."""

import math
from dataclasses import replace
from typing import Any, List, Tuple

import numpy as np
import pytest
from conftest import map_of
from test_agent import Bench, corridor, reply
from test_scene_file import decisions

from explorer.explanation import reason_of
from explorer.forecast import rest_of
from explorer.foreign import Element
from explorer.messages import Auction
from explorer.report import MOST_LEFT, Report
from explorer.statement import Stage
from explorer.status import State


def report(bench: Bench) -> Report:
    return bench.agent.report(bench.now)


def in_auction(bids: List[float], strategy: int = 7) -> Tuple[Bench, Auction]:
    """One auction with bids of robot_1, which stands far on the right."""
    bench = Bench(strategy).map(corridor()).join("robot_1", position=(8.0, 0.0))
    bench.run(0.2)
    start = next(auction for auction in bench.auctions() if auction.start)
    bench.agent.on_auction(reply(start, "robot_1", bids), bench.now)
    bench.run(0.4)
    return bench, start


def test_before_there_is_a_map() -> None:
    bench = Bench(7)
    bench.run(0.4)
    told = report(bench)
    assert (told.reason, told.bids, told.assignment, told.left, told.team) == ("", {}, {}, (), {})
    assert told.area == 0.0 and math.isnan(told.rest) and told.status.state == State.STARTING


def test_bids_told_and_heard_and_the_reason_of_the_goal() -> None:
    bench, start = in_auction([50.0, 60.0])
    told = report(bench)
    own = bench.agent.mission.claim.number
    assert set(told.bids) == {"robot_0", "robot_1"} and told.bids["robot_1"] in (50.0, 60.0)
    row = [offer.elements[0][1] for offer in start.requested].index(
        min(n for n in bench.agent.mission.scene(bench.now).cluster(own).numbers)  # type: ignore[union-attr]
    )
    assert told.bids["robot_1"] == [50.0, 60.0][row] and told.unit == 7 and told.strategy == "coordinated"
    expected = f"bid {told.bids['robot_0']:.1f} m, the lowest of 2 clusters; robot_1 bids {told.bids['robot_1']:.1f} m"
    assert told.reason == expected


def test_all_bids_of_the_last_auction_are_told_with_who_explores_what() -> None:
    """The page of a team showed the bids for the cluster that a robot took, not those that lost."""
    assert report(Bench(7).map(corridor())).auction is None
    bench, start = in_auction([50.0, -1.0])
    told = report(bench).auction
    assert told is not None and told.auction_id == start.auction_id and len(told.offers) == 2
    first, second = told.offers
    assert first.bids["robot_1"] == 50.0 and "robot_1" not in second.bids
    assert [offer.bids["robot_0"] for offer in told.offers] == [offer.bid for offer in start.requested]
    own = bench.agent.mission.scene(bench.now).current  # type: ignore[union-attr]
    assert [offer.place for offer in told.offers if offer.explored_by == "robot_0"] == [own.place]
    assert sorted(offer.explored_by for offer in told.offers) == ["", "robot_0"]


def beside_robot_1() -> Bench:
    """Of two clusters robot_1 has said that it explores the left one."""
    bench = Bench(7).map(corridor()).join("robot_1", position=(-8.0, 0.0))
    elements = [Element("robot_1", 10000 + i, -3.9, -1.2 + 0.2 * i) for i in range(13)]
    bench.agent.on_frontiers(elements, bench.now)
    closing = Auction("robot_1", 10001, True, finished=True, occupied=tuple(e.key for e in elements))
    bench.agent.on_auction(closing, bench.now)
    return bench


def test_a_cluster_that_another_robot_explores_is_told_as_its_own() -> None:
    bench = beside_robot_1()
    bench.run(3.0)
    told = report(bench).auction
    assert told is not None
    assert {offer.explored_by: offer.place[0] > 0.0 for offer in told.offers} == {"robot_0": True, "robot_1": False}


@pytest.mark.parametrize(
    "strategy, reason", [(0, "nearest frontier by travel path"), (2, "furthest frontier"), (4, "random frontier")]
)
def test_the_reason_of_a_strategy_without_clusters_is_its_title(strategy: int, reason: str) -> None:
    bench = Bench(strategy).map(corridor())
    bench.run(1.0)
    assert report(bench).reason == reason


def test_a_choice_that_is_not_the_cheapest_says_how_many_are() -> None:
    """`1 of them lower of 9 clusters` was hard to read."""
    bench, _ = in_auction([50.0, 60.0])
    mission, strategy = bench.agent.mission, bench.agent.mission.strategy
    scene, goal = mission.scene(bench.now), mission.driver.goal
    assert scene is not None and goal is not None
    dearest = max(scene.open, key=lambda each: strategy.bid(scene, each))  # type: ignore[attr-defined]
    reason = reason_of(replace(goal, cluster=dearest.number), State.EXPLORING, strategy, scene, {})
    assert reason.endswith(" m, 1 of 2 clusters is cheaper")


def test_reasons_of_the_only_cluster_and_of_the_way_home() -> None:
    bench = Bench(1).map(corridor(left=False))
    bench.run(1.0)
    assert report(bench).reason.endswith("m^2, the only cluster left to it")
    bench.place(3.0, 0.0)
    bench.agent.go_home(bench.now)
    bench.run(0.4)
    told = report(bench)
    assert (told.reason, told.ended_by, told.rest) == ("the way home", "sent home", 0.0)


def test_who_explores_which_cluster() -> None:
    bench = beside_robot_1()
    bench.run(2.0)
    places = report(bench).assignment
    assert set(places) == {"robot_0", "robot_1"}
    assert places["robot_1"] == pytest.approx((-3.9, 0.0)) and places["robot_0"][0] > 2.0


def test_known_area_is_that_of_the_map() -> None:
    bench = Bench(7).map(map_of(np.pad(np.zeros((30, 40)), 5, constant_values=-1), 0.1, -2.0, -2.0))
    assert report(bench).area == pytest.approx(12.0)


def test_the_rest_is_the_tour_at_the_speed_so_far() -> None:
    """The robot is at x = 0.5; looks at both ends of the known part at x = -4 and 4 from about a metre away."""
    bench = Bench(7).map(corridor())
    bench.run(0.4)
    scene = bench.agent.mission.scene(bench.now)
    assert scene is not None and len(scene.candidates) == 2
    count, length, rest = rest_of(scene, driven=10.0, time=20.0)
    assert count == 2 and 8.0 < length < 14.0 and rest == pytest.approx(2.0 * length)
    assert math.isnan(rest_of(scene, driven=0.0, time=20.0)[2])
    assert math.isnan(rest_of(scene, driven=0.0, time=0.0)[2])
    claim = Bench(7)  # the left end is another robot's
    claim.map(corridor(left=False)).run(0.4)
    alone = claim.agent.mission.scene(claim.now)
    assert alone is not None and rest_of(alone, 10.0, 20.0)[1] < length / 2
    assert rest_of(replace(alone, clusters=(), ready=frozenset()), 10.0, 20.0) == (0, 0.0, 0.0)


def test_claimed_clusters_are_not_in_the_rest() -> None:
    scene = max((made.scene for made in decisions(7)), key=lambda scene: len(scene.claimed))
    assert scene.claimed
    free = rest_of(scene, 1.0, 1.0)
    everything = rest_of(replace(scene, claims={}), 1.0, 1.0)
    assert free[0] == everything[0] - len(scene.claimed) and free[1] < everything[1]


def test_many_clusters_take_their_share_of_the_way(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = next(made.scene for made in decisions(7) if len(made.scene.candidates) >= 6)
    exact = rest_of(replace(scene, claims={}), 1.0, 1.0)
    monkeypatch.setattr("explorer.forecast.MAXIMUM_STOPS", 4)
    rough = rest_of(replace(scene, claims={}), 1.0, 1.0)
    assert rough[0] == exact[0] and 0.3 * exact[1] < rough[1] < 3.0 * exact[1]


def walled() -> Any:
    """A corridor with a window: 3 m of frontier behind a gap of two cells, which no robot gets through."""
    cells = corridor(left=False).cells.copy()
    cells[:, 100] = 100
    cells[15:17, 100] = 0
    return map_of(cells, 0.1, -10.0, -1.6)


def test_what_is_left_and_why() -> None:
    bench = Bench(7).map(walled())
    bench.place(-5.0, 0.0)
    bench.run(0.4)
    left = report(bench).left
    assert [each.reason for each in left] == ["too narrow: 0.2 m"]
    assert left[0].place == pytest.approx((3.9, 0.0), abs=0.2) and left[0].points >= 10
    assert left[0].size == pytest.approx(2.8, abs=0.4)


def test_what_no_robot_would_see_is_not_told_as_too_narrow() -> None:
    cells = walled().cells.copy()
    cells[15:17, 99:101] = (0, 100)  # the window is walled up
    bench = Bench(7).map(map_of(cells, 0.1, -10.0, -1.6))
    bench.place(-5.0, 0.0)
    bench.run(0.4)
    assert {each.reason for each in report(bench).left} == {"no place to look from"}


def test_what_is_left_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    assert MOST_LEFT == 100
    monkeypatch.setattr("explorer.report.MOST_LEFT", 0)
    bench = Bench(7).map(walled())
    bench.place(-5.0, 0.0)
    bench.run(0.4)
    assert report(bench).left == ()


def test_given_up_and_told_frontiers_say_so() -> None:
    bench = Bench(3, number_unreachable_for_cluster=1).map(corridor(left=False))
    for _ in range(2):
        bench.run(9.0)
        assert bench.agent.goal is not None
        bench.agent.on_goal_result(bench.agent.goal.goal_id, "failed", "no way", bench.now)
    bench.run(0.4)
    assert "given up" in {each.reason for each in report(bench).left}
    other = Bench(7).map(corridor(left=False)).join("robot_1")
    other.run(0.4)
    points = [(f.x, f.y) for f in other.agent.perception.frontiers.ordered()]
    other.agent.on_visited_frontiers([Element("robot_1", i, *place) for i, place in enumerate(points)], other.now)
    other.map(corridor(left=False)).run(0.4)
    assert {each.reason for each in report(other).left} == {"told by robot_1"}


def test_which_robots_have_finished() -> None:
    """One that bids nothing and claims nothing; not one whose bids are on their way, or that has no transform."""
    bench = Bench(7).map(corridor()).join("robot_1", "robot_2", "robot_3")
    bench.agent.on_transform("robot_3", None, bench.now)
    bench.run(0.2)
    assert report(bench).team == {"robot_1": None, "robot_2": None, "robot_3": None}
    start = next(auction for auction in bench.auctions() if auction.start)
    for robot in ("robot_1", "robot_3"):
        bench.agent.on_auction(Auction(robot, start.auction_id, status=False), bench.now)
    bench.agent.on_auction(reply(start, "robot_2", [5.0] * len(start.requested)), bench.now)
    assert report(bench).team == {"robot_1": Stage.ENDED, "robot_2": None, "robot_3": None}
    bench.agent.on_auction(Auction("robot_1", 1, True, finished=True, occupied=(("robot_1", 5),)), bench.now)
    assert report(bench).team["robot_1"] is None
    bench.agent.on_robots(["robot_2"], bench.now)
    assert set(report(bench).team) == {"robot_2"}


def test_a_report_changes_no_decision() -> None:
    """Strategies keep what they have computed for a scene; asking in between must not show."""

    def goals(ask: bool) -> list:
        bench = Bench(7).map(corridor()).join("robot_1", position=(8.0, 0.0))
        for step in range(100):
            bench.place(0.5 + 0.02 * step, 0.0)
            bench.run(0.2)
            if ask:
                report(bench)
        return [effect for effect in bench.effects]

    assert goals(ask=True) == goals(ask=False)
