"""What is worth a visit: the unknown behind a frontier, whether the robot fits in, what is left and why."""

from typing import Dict, List, Optional, Sequence

import numpy as np
import pytest
from conftest import drawn, map_of
from usual_robot import LARGEST

from explorer._kernels import unknown_behind
from explorer.clusters import Cluster
from explorer.frontiers import Frontier
from explorer.grid import OccupancyMap
from explorer.leftovers import UNSEEN, leftovers, sentence
from explorer.prospects import Prospect, enterable, prospects
from explorer.verdicts import Verdicts
from explorer.ways import Ways
from explorer.worth import (
    FEW_POINTS,
    GIVEN_UP,
    NOISE,
    NOT_WORTH_THE_WAY,
    TOLD,
    VISITED,
    Worth,
    too_much_to_leave,
    without_detours,
    worth_of,
)

ROOM = Prospect(area=3.0, enterable=2.0, depth=2.0, passable=True)
POCKET = Prospect(area=0.6, enterable=0.3, depth=0.8, passable=True)
GAP = Prospect(area=0.1, enterable=0.0, depth=0.1, passable=False)


def points(count: int) -> List[Frontier]:
    return [Frontier(number, 0.2 * number, 0.0) for number in range(count)]


def cluster_of(count: int, cost: float = 1.0) -> Cluster:
    members = tuple(points(count))
    return Cluster(0, members, cost, (0.0, 0.0), 0, views={member.number: (0.0, 0.0, cost) for member in members})


def nothing_known(x: float, y: float) -> float:
    return 0.0


def verdicts_on(cluster: Cluster) -> Verdicts:
    verdicts = Verdicts()
    verdicts.follow(cluster.members, [])
    return verdicts


def judged(seen: Sequence[Prospect], verdicts: Optional[Verdicts] = None) -> Worth:
    cluster = cluster_of(len(seen))
    behind: Dict[int, Prospect] = dict(enumerate(seen))
    return worth_of([cluster], behind, verdicts or verdicts_on(cluster), nothing_known, 0.0)


# Two rooms; the wall between has a door at the left and a slit at the right that no robot passes.
PLAN = [
    "#######################",
    "#                     #",
    "#                     #",
    "#                     #",
    "#                     #",
    "#                     #",
    "#                     #",
    "####      ######### ###",
    "#.....................#",
    "#.....................#",
    "#.....................#",
    "#.....................#",
    "#######################",
]


def seen_through(door: bool) -> OccupancyMap:
    rows = list(PLAN)
    if not door:
        rows[7] = "################### ###"
    return drawn(rows, scale=2, resolution=0.05)


DOOR, SLIT = Frontier(1, 0.7, 0.45), Frontier(2, 1.95, 0.45)


def test_a_door_leads_somewhere_and_a_slit_does_not() -> None:
    behind = prospects([DOOR, SLIT], Ways(seen_through(door=False), 0.1, (), LARGEST), (0.3, 0.3))
    assert behind[DOOR.number].area == 0.0 and behind[SLIT.number].area > 0.2
    assert behind[SLIT.number].enterable == 0.0


def test_what_is_seen_through_a_slit_counts_where_a_door_leads_there_too() -> None:
    behind = prospects([DOOR, SLIT], Ways(seen_through(door=True), 0.1, (), LARGEST), (0.3, 0.3))
    assert behind[DOOR.number].enterable > 0.5 and behind[DOOR.number].passable
    assert behind[SLIT.number].enterable > 0.1


def test_a_slit_far_from_every_door_leads_nowhere() -> None:
    """The corner of an outer wall that nobody has seen yet is a slit to all that is outside."""
    rows = ["#" * 7 + " " * 6 + "#" * 77 + " " * 4 + "#" * 6, *["#" + "." * 98 + "#"] * 8, "#" * 100]
    ways = Ways(drawn([*[" " * 100] * 40, *rows], scale=1, resolution=0.1), 0.25, (), LARGEST)
    door, slit = Frontier(1, 1.0, 0.85), Frontier(2, 9.2, 0.85)
    behind = prospects([door, slit], ways, (1.0, 0.5))
    assert behind[door.number].enterable > 1.0
    assert behind[slit.number].area > 0.5 and behind[slit.number].enterable == 0.0


def test_the_robot_may_stand_only_where_it_can_get_to() -> None:
    ways = Ways(seen_through(door=False), 0.1, (), LARGEST)
    inside = enterable(ways, (0.3, 0.3))
    assert inside[6, 6] and not inside[20, 20] and not inside[0, 0]


def test_no_frontiers_no_prospects() -> None:
    assert prospects([], Ways(seen_through(door=True), 0.1, (), LARGEST), (0.3, 0.3)) == {}


def test_unknown_off_the_map_counts() -> None:
    ways = Ways(map_of(np.zeros((20, 20))), 0.1, (), LARGEST)
    assert prospects([Frontier(1, 1.95, 1.0)], ways, (1.0, 1.0))[1].area > 3.0


def test_rays_end_at_walls_and_behind_the_unknown() -> None:
    cells = np.zeros((11, 31), dtype=np.int8)
    cells[2:9, 12:18] = -1
    cells[:, 18:22] = 100
    cells[:, 22:] = -1
    areas, depths = unknown_behind(cells, 50, np.zeros(cells.shape, dtype=bool), np.array([[5, 11]]), 15, 2)
    assert 6.0 <= depths[0] <= 9.0 and areas[0, 1] == 0.0
    assert areas[0, 0] == pytest.approx(42, rel=0.25)


@pytest.mark.parametrize("wrong", [np.zeros((3, 3), dtype=bool), np.zeros(4, dtype=bool)])
def test_the_kernel_refuses_arrays_that_do_not_fit(wrong: np.ndarray) -> None:
    with pytest.raises(ValueError, match="same shape"):
        unknown_behind(np.zeros((4, 4), dtype=np.int8), 50, wrong, np.zeros((0, 2), dtype=np.int64), 5, 1)


def test_an_opening_of_two_points_is_a_goal_and_noise_is_not() -> None:
    worth = judged([ROOM, ROOM, GAP])
    assert set(worth.goals) == {0, 1} and worth.reasons == {2: NOISE}


def test_a_single_point_in_a_place_too_narrow_is_no_goal() -> None:
    narrow = ROOM._replace(passable=False)
    assert judged([narrow, GAP]).reasons == {0: FEW_POINTS, 1: NOISE}


def test_verdicts_come_before_what_is_seen() -> None:
    verdicts = verdicts_on(cluster_of(4))
    for now in (0.0, 2.0):
        verdicts.look(None, lambda verdict: verdict.x == 0.0, nothing_known, now)
        verdicts.judge_looked(now + 1.0, lambda x, y: 9, nothing_known)
    verdicts.fail_cluster(0, [1], 1, lambda x, y: 0)
    worth = judged([ROOM, ROOM, ROOM, ROOM], verdicts)
    assert worth.reasons == {0: VISITED, 1: GIVEN_UP} and set(worth.goals) == {2, 3}


def test_told_by_another_robot() -> None:
    verdicts = verdicts_on(cluster_of(3))
    verdicts.believe_explored("robot_1", 0.0, 0.0, 0.0)
    worth = judged([ROOM, ROOM, ROOM], verdicts)
    assert worth.told == {"robot_1"} and set(worth.reasons.values()) == {TOLD.format("robot_1")}


@pytest.mark.parametrize("seen, cost, goes", [(POCKET, 1.0, True), (POCKET, 10.0, False), (ROOM, 100.0, True)])
def test_a_pocket_is_worth_a_short_way_and_an_opening_any(seen: Prospect, cost: float, goes: bool) -> None:
    behind = dict.fromkeys(range(3), seen)
    cluster = cluster_of(3, cost)
    worth = worth_of([cluster], behind, verdicts_on(cluster), nothing_known, 0.0)
    (kept,), worth = without_detours([cluster], worth, behind)
    assert kept.reachable == goes
    assert set(worth.reasons.values()) == (set() if goes else {NOT_WORTH_THE_WAY})
    assert bool(worth.goals) == goes


def test_pieces_are_left_only_while_they_are_little_together() -> None:
    behind = dict.fromkeys(range(3), POCKET)
    cluster = cluster_of(3, 50.0)
    worth = worth_of([cluster], behind, verdicts_on(cluster), nothing_known, 0.0)
    (cluster,), worth = without_detours([cluster], worth, behind)
    assert too_much_to_leave([cluster], worth, behind, free_area=1000.0) == {}
    assert set(too_much_to_leave([cluster], worth, behind, free_area=10.0)) == {0, 1, 2}


def test_what_was_visited_is_never_taken_up_again() -> None:
    behind = dict.fromkeys(range(3), ROOM)
    cluster = cluster_of(3)
    worth = Worth({}, dict.fromkeys(range(3), VISITED), False)
    assert too_much_to_leave([cluster], worth, behind, free_area=1.0) == {}


def test_what_is_left_is_told_with_place_size_and_reason() -> None:
    behind = dict.fromkeys(range(3), POCKET)
    cluster = Cluster(0, tuple(points(3)))
    (left,) = leftovers([cluster], Worth({}, dict.fromkeys(range(3), NOT_WORTH_THE_WAY), False), behind)
    assert (left.points, left.area, left.reason) == (3, 0.6, NOT_WORTH_THE_WAY)
    assert sentence([left]) == "left unexplored at 1 places: (0.2, 0.0) 0.6 m² not worth the way"
    assert leftovers([cluster], Worth({}, {}, False), behind)[0].reason == UNSEEN
    assert sentence([]) == "nothing is left unexplored"


def test_only_the_largest_of_what_is_left_is_named() -> None:
    behind = {number: GAP._replace(area=float(number)) for number in range(30)}
    clusters = [Cluster(point.number, (point,)) for point in points(30)]
    left = leftovers(clusters, Worth({}, {}, False), behind)
    assert left[0].area == 29.0 and "and 22 smaller ones" in sentence(left)
