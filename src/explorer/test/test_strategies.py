"""Strategies decide from a scene alone: their order, bids and choices on small scenes, and the registry."""

from dataclasses import replace
from typing import Any, List, Optional, Tuple

import numpy as np
import pytest
from conftest import map_of
from usual_robot import LARGEST

from explorer import plan
from explorer.clusters import Cluster
from explorer.frontiers import Frontier
from explorer.recognition import Listed
from explorer.scene import Scene
from explorer.shares import Errand, Tour, share_out
from explorer.strategies import TITLES, number_of, strategy_of
from explorer.strategies.coordinated import travel_bid
from explorer.strategies.strategy import FrontierStrategy, registered
from explorer.ways import Ways
from mr_grid import Pose

HALL = Ways(map_of(np.zeros((100, 200))), 0.25, [], LARGEST)  # 20 m x 10 m


def cluster(number: int, x: float, y: float = 5.0, gain: float = 1.0) -> Cluster:
    """Three points seen from where they are; the robot is at (5, 5)."""
    members = tuple(Frontier(10 * number + i, x, y + 0.2 * i) for i in range(3))
    cost = float(np.hypot(x - 5.0, y - 5.0))
    views = {member.number: (member.x, member.y, cost) for member in members}
    return Cluster(number, members, cost, (x, y), members[0].number, gain, views)


def scene(*clusters: Cluster, **known: Any) -> Scene:
    ready = frozenset(member.number for each in clusters for member in each.members)
    return Scene(0.0, Pose(5.0, 5.0, 0.0), HALL, tuple(clusters), ready, **known)


def strategy(number: int, seed: int = 0) -> Any:
    return strategy_of(number)(np.random.default_rng(seed))


def listed(*places: Tuple[float, float], own: Tuple[int, ...] = ()) -> Listed:
    return Listed(frozenset(own), np.array(places, dtype=float).reshape(-1, 2))


def chosen(number: int, what: Scene, bids: Optional[dict] = None) -> Optional[int]:
    found = strategy(number).choose(what, bids or {})
    return None if found is None else found.number


def test_numbers_of_the_contract_and_names() -> None:
    assert list(TITLES) == list(range(8))
    assert all(strategy_of(strategy_of(number).name) is strategy_of(number) for number in TITLES)
    with pytest.raises(KeyError, match="'best' is unknown; there are 0 nearest_path, 1 auction"):
        strategy_of("best")
    assert [number_of(key) for key in ("7", "coordinated")] == [7, 7]
    with pytest.raises(KeyError, match=r"and those that EXPLORER_STRATEGIES=FILE\.py:Class names"):
        number_of("100")
    with pytest.raises(KeyError, match=r"set EXPLORER_STRATEGIES=x\.py:Mine, then"):
        number_of("x.py:Mine")
    with pytest.raises(ValueError, match="registered twice"):
        registered(type("Other", (FrontierStrategy,), {"number": 3, "name": "other", "title": ""}))


def test_scenes_take_over_what_still_holds() -> None:
    """In a team of sixteen a robot decides sixty times a second; a third of the time went into who claims what."""
    first = scene(cluster(1, 7.0), cluster(2, 9.0), claims={"robot_1": listed((9.0, 5.0), (9.0, 5.2))})
    assert (first.claimed, len(first.views)) == ({2: "robot_1"}, 6)
    later, busy, unclaimed, other = (
        replace(first, **change)
        for change in ({"now": 1.0}, {"ready": frozenset([10])}, {"claims": {}}, {"clusters": first.clusters[:1]})
    )
    for each in (later, busy, unclaimed, other):
        each.take_over(first)
    assert later.claimed is first.claimed and later.open is first.open
    assert busy.views is first.views and [each.number for each in busy.open] == [1] and not busy.claimed
    assert unclaimed.open is first.open and not unclaimed.claimed
    assert len(other.views) == 3 and not other.claimed


def test_costs_of_others_are_looked_up_once_for_each_place(monkeypatch: pytest.MonkeyPatch) -> None:
    known, one, asked = scene(cluster(1, 7.0), positions={"robot_1": (6.0, 5.0)}), strategy(7), []
    monkeypatch.setattr(Ways, "from_robot", lambda self, place: asked.append(place) or self.grid.field_from(*place))
    costs = [one.estimate(each, place, each.clusters[0]) for each in (known, replace(known, now=1.0))
             for place in ((6.0, 5.0), (3.0, 5.0))]  # fmt: skip
    assert asked == [(6.0, 5.0), (3.0, 5.0)] and costs[:2] == costs[2:] and costs[0] < costs[1]
    large = replace(known, team=("a", "b", "c", "d"))
    assert one.estimate(large, (6.0, 5.0), large.clusters[0]) != costs[0], "in a large team bids are ways alone"
    assert one.estimate(replace(known), (6.0, 5.0), known.clusters[0]) == costs[0]


def test_robots_near_one_place_share_a_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """In a team of sixteen somebody has moved at every step, mostly by less than ways tell apart."""
    known, one, asked = scene(cluster(1, 7.0)), strategy(7), []
    monkeypatch.setattr(Ways, "from_robot", lambda self, place: asked.append(place) or self.grid.field_from(*place))
    assert len({one.estimate(known, (x, 5.0), known.clusters[0]) for x in (3.0, 3.1, 3.2)}) == 1
    assert asked == [(3.0, 5.0)]
    walled_in = replace(known.clusters[0], viewpoint=(7.0, 50.0))
    far = replace(known, clusters=(walled_in,))
    costs = [one.estimate(far, (x, 5.0), walled_in) for x in (3.0, 3.1)]
    assert costs[0] != costs[1], "without a way the distance counts, from where the robot is"


def test_what_was_shared_out_last_holds_until_something_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    """A robot without a share asks at every step."""
    count = 0

    def counting(errand: Errand) -> List[Tour]:
        nonlocal count
        count += 1
        return share_out(errand)

    monkeypatch.setattr(plan, "share_out", counting)
    team = tuple(f"robot_{number}" for number in range(1, 6))
    known = scene(cluster(1, 7.0), cluster(2, 12.0), positions={"robot_1": (8.0, 5.0)}, competitors=team[:1], team=team)
    one, changes = strategy(7), (
        {"positions": {"robot_1": (14.0, 5.0)}},
        {"pose": Pose(5.0, 5.0, 2.0)},
        {"competitors": ()},
        {"own": 2},
        {"claims": {"robot_1": listed((12.0, 5.0), (12.0, 5.2), (12.0, 5.4))}},
        {"ready": frozenset([10])},
        {"clusters": (cluster(1, 7.0), cluster(2, 12.0, gain=9.0))},
    )  # fmt: skip
    for change in changes:
        one.choose(known, {})
        before = count
        assert one.choose(replace(known, now=1.0), {}) is one.choose(known, {}) and count == before
        other = replace(known, **change)
        assert one.choose(other, {}) is strategy(7).choose(other, {}) and count == before + 2, change


def test_order_of_frontiers() -> None:
    """The second is nearer in a straight line, its way is longer."""
    first, second, third = cluster(1, 7.0), replace(cluster(2, 4.0), views={20: (4.0, 5.0, 9.0)}), cluster(3, 15.0)
    known = scene(first, second, third)
    points = [first.members[0], second.members[0], third.members[0]]
    assert [f.number for f in strategy(0).order(known, points)] == [10, 20, 30]
    assert [f.number for f in strategy(3).order(known, points)] == [20, 10, 30]
    assert [f.number for f in strategy(2).order(known, points)] == [30, 10, 20]


def test_random_orders_depend_on_the_seed_alone() -> None:
    known = scene(*(cluster(number, float(number)) for number in range(1, 15)))

    def orders(seed: int) -> List[list]:
        frontiers = [f.number for f in strategy(4, seed).order(known, known.frontiers)]
        return [frontiers, [c.number for c in strategy(6, seed).order(known)]]

    assert orders(1) == orders(1)
    assert orders(1)[0] != orders(2)[0] and orders(1)[1] != orders(2)[1]


@pytest.mark.parametrize("number", [0, 1, 2, 3, 4, 5, 6])
def test_bid_of_the_paper_is_the_whole_part_of_the_squared_distance(number: int) -> None:
    known = scene(cluster(1, 7.6))
    assert strategy(number).bid(known, known.clusters[0]) == 6.0


@pytest.mark.parametrize("number", [1, 5, 7])
def test_alone_the_nearest_cluster(number: int) -> None:
    assert chosen(number, scene(cluster(1, 12.0), cluster(2, 7.0))) == 2
    assert chosen(number, scene()) is None


@pytest.mark.parametrize("number", [1, 5, 6, 7])
def test_a_claimed_cluster_is_left_to_the_other(number: int) -> None:
    claims = {"robot_1": listed((7.0, 5.0), (7.0, 5.2), (7.0, 5.4))}
    assert chosen(number, scene(cluster(1, 12.0), cluster(2, 7.0), claims=claims)) == 1


@pytest.mark.parametrize("number", [1, 7])
def test_a_robot_that_bids_less_gets_the_nearer_cluster(number: int) -> None:
    known = scene(cluster(1, 12.0), cluster(2, 7.0), competitors=("robot_1",))
    assert chosen(number, known, {"robot_1": {1: 900.0, 2: 0.5}}) == 1
    assert chosen(number, known, {"robot_1": {1: 0.5, 2: 900.0}}) == 2


@pytest.mark.parametrize("number", [1, 7])
def test_without_a_bid_the_place_of_a_robot_counts(number: int) -> None:
    known = scene(cluster(1, 2.0), cluster(2, 7.0), competitors=("robot_1",), positions={"robot_1": (8.0, 5.0)})
    assert chosen(number, known) == 1
    assert chosen(number, replace(known, positions={})) == 2


def test_a_robot_that_has_nothing_else_takes_what_another_claims_and_is_far_from() -> None:
    """The claim made the cluster cost more, as if the other were working beside it: a robot 4 m away stood in a door
    with nothing to do while the one that had claimed it came from 12 m away and could not get past."""
    claims = {"robot_1": listed((9.0, 5.0), (9.0, 5.2), (9.0, 5.4))}
    known = scene(cluster(1, 9.0), claims=claims, competitors=("robot_1",))
    assert chosen(7, known, {"robot_1": {1: 12.0}}) == 1
    assert chosen(7, known, {"robot_1": {1: 8.0}}) is None


def test_loyalty_of_strategy_7() -> None:
    known = scene(cluster(1, 7.5), cluster(2, 2.9))
    other = {1: 2, 2: 1}[chosen(7, known) or 0]
    assert chosen(7, replace(known, own=other)) == other


def test_bid_of_strategy_7() -> None:
    assert travel_bid(5.0, 0.0) < travel_bid(6.0, 0.0)
    assert travel_bid(5.0, 4.0) < travel_bid(5.0, 0.0)
    assert travel_bid(5.0, 0.0, turn=1.0) > travel_bid(5.0, 0.0)
    assert travel_bid(5.0, 0.0, detour=3.0) > travel_bid(5.0, 0.0)
    assert travel_bid(-100.0, 0.0) == 0.0, "no bid is below 0, which means none"


def test_larger_teams_bid_the_way_with_the_turn() -> None:
    """Bids that hold what a robot would gain or lose elsewhere cannot be compared: a robot 9 m away lost a room to one
    14 m away because clusters in a third robot's room would have been a detour."""
    ahead, behind, side = cluster(1, 9.0, gain=8.0), cluster(2, 1.0), cluster(3, 5.0, 9.0)
    known = large(ahead, behind, side, robot_1=(9.0, 9.0), robot_2=(1.0, 9.0))
    assert strategy(7).bid(known, ahead) == pytest.approx(4.0)
    assert strategy(7).bid(known, behind) == pytest.approx(4.0 + 0.4 * np.pi)
    assert strategy(7).bid(known, side) == pytest.approx(4.0 + 0.2 * np.pi)


def placed(*clusters: Cluster, **others: Tuple[float, float]) -> Scene:
    return scene(*clusters, competitors=tuple(others), positions=others)


def large(*clusters: Cluster, **others: Tuple[float, float]) -> Scene:
    """In a team of five or more; who is not mentioned is far away and does not know the clusters."""
    team = tuple(sorted({*others, *(f"robot_{number}" for number in range(1, 5))}))
    return scene(*clusters, competitors=team, positions=others)


def test_far_clusters_have_their_robot_before_the_near_ones_are_done() -> None:
    """Each of three robots took the nearest cluster of the west wing, and one had the whole east wing to itself."""
    west = [cluster(number, 1.0, 2.0 + 1.5 * number) for number in range(5)]
    east = [cluster(10 + number, 15.0, 2.0 + 2.0 * number) for number in range(3)]
    found = chosen(7, large(*west, *east, robot_1=(3.0, 3.0), robot_2=(3.0, 7.0)))
    assert found is not None and found >= 10


def test_a_claim_gives_way_to_a_robot_that_is_far_nearer() -> None:
    claims = {"robot_1": listed((7.0, 5.0), (7.0, 5.2), (7.0, 5.4))}
    clusters = (cluster(1, 12.0), cluster(2, 7.0))
    for x, taken in ((9.0, 1), (19.0, 2)):
        assert chosen(7, replace(large(*clusters, robot_1=(x, 5.0), robot_2=(1.0, 9.0)), claims=claims)) == taken


def test_a_robot_without_a_share_comes_to_help() -> None:
    """It stood still while the others had more than one cluster each, and was far from what they found."""
    row = [cluster(number, 12.0 + 1.2 * number) for number in range(3)]
    others = {"robot_1": (11.5, 5.0), "robot_2": (11.5, 5.2)}
    assert chosen(7, large(*row, **others)) is not None
    assert chosen(7, large(row[0], **others)) is None


def test_robots_of_a_small_team_have_one_cluster_each() -> None:
    """With two robots sharing out took longer; their bids hold the detour."""
    known = placed(cluster(1, 9.0), cluster(2, 2.0), robot_1=(4.0, 5.0))
    assert strategy(7).bid(known, known.clusters[0]) == travel_bid(4.0, 1.0, detour=1.0)
    assert chosen(7, known) == 1


def test_a_decision_depends_on_the_scene_alone() -> None:
    """A strategy that has decided other scenes before decides this one as a new one does."""
    scenes = [scene(cluster(1, 7.0 + i), cluster(2, 12.0 - i), cluster(3, 5.0, 2.0 + 0.5 * i)) for i in range(5)]
    old = strategy(7)
    for known in [*scenes, *scenes[::-1]]:
        bids = [old.bid(known, each) for each in known.clusters]
        assert bids == [strategy(7).bid(known, each) for each in known.clusters]


def test_only_clusters_with_something_to_try_are_open() -> None:
    known = scene(cluster(1, 7.0), cluster(2, 12.0))
    waiting = replace(known, ready=frozenset({20}), own=1)
    assert [c.number for c in waiting.open] == [2] and [c.number for c in waiting.candidates] == [1, 2]
    assert [f.number for f in waiting.frontiers] == [20] and waiting.current is None


# ---- robots that hear each other and cannot place each other yet ---------------------------------------------------


def parting(rank: int, *clusters: Cluster, **known: Any) -> Optional[int]:
    """What the robot of that rank among four chooses; the others are heard."""
    names = [f"robot_{number}" for number in range(4)]
    others = tuple(name for name in names if name != names[rank])
    return chosen(7, scene(*clusters, name=names[rank], team=others, start=(5.0, 5.0), **known))


AROUND = (cluster(1, 5.0, 3.5), cluster(2, 12.0, 5.0), cluster(3, 5.0, 9.0), cluster(4, 3.0, 5.1))


def test_robots_that_cannot_place_each_other_part_by_rank() -> None:
    """All four turned to the nearest frontier behind them, and stood in each other's way for the first 20 s."""
    assert [parting(rank, *AROUND) for rank in range(4)] == [1, 2, 3, 4]
    assert [parting(rank, *AROUND[:2]) for rank in range(4)] == [1, 1, 2, 2]


def test_the_direction_of_the_rank_is_kept_until_its_cluster_is_empty() -> None:
    assert parting(0, *AROUND, own=3) == 3
    assert parting(0, *AROUND, own=9) == 1


def test_ranks_do_not_send_a_robot_far_away() -> None:
    far = replace(cluster(2, 19.0), cost=14.0)
    assert {parting(rank, cluster(1, 5.0, 3.5), far) for rank in range(4)} == {1}


def test_bids_decide_again_once_a_robot_is_placed_alone_or_away_from_the_start() -> None:
    placed = {"positions": {"robot_0": (19.0, 9.0)}}
    assert chosen(7, scene(*AROUND, name="robot_1", team=("robot_0",), start=(5.0, 5.0), **placed)) == 1
    assert chosen(7, scene(*AROUND, name="robot_1", start=(5.0, 5.0))) == 1
    assert chosen(7, scene(*AROUND, name="robot_1", team=("robot_0",), start=(15.0, 5.0))) == 1


def test_costs_are_interpolated_only_for_robots_that_did_not_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each interpolation from another place is a field over the whole map."""
    positions = {"robot_1": (6.0, 5.0), "robot_2": (14.0, 5.0), "robot_3": (10.0, 2.0)}
    what = scene(cluster(1, 3.0), cluster(2, 16.0), positions=positions, competitors=tuple(positions))
    bids = {"robot_1": {1: 4.0}, "robot_2": {1: 9.0, 2: 3.0}}
    asked = []
    monkeypatch.setattr(Ways, "from_robot", lambda self, place: asked.append(place) or self.grid.field_from(*place))
    chosen(7, what, bids)
    assert set(asked) == {(10.0, 2.0)}
