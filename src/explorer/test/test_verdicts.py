"""Verdicts on frontier points: visited, given up, revived, and what other robots tell."""

from typing import Callable, Dict, List, Optional, Tuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from explorer.frontiers import Frontier
from explorer.verdicts import Verdict, Verdicts


def known(*points: Frontier) -> Verdicts:
    verdicts = Verdicts()
    verdicts.follow(points, [])
    return verdicts


POINT = Frontier(7, 1.0, 2.0)


def everything(_: Verdict) -> bool:
    return True


def cells_near(count: int):  # type: ignore[no-untyped-def]
    return lambda x, y: count


def area_near(area: float):  # type: ignore[no-untyped-def]
    return lambda x, y: area


def look_until_visited(verdicts: Verdicts) -> None:
    for now in (0.0, 2.0):
        verdicts.look(None, everything, area_near(1.0), now)
        verdicts.judge_looked(now + 1.0, cells_near(9), area_near(1.0))


def test_a_look_ends_with_a_map_that_was_made_after_it() -> None:
    verdicts = known(POINT)
    verdicts.look(POINT.number, lambda _: False, area_near(1.0), 1.0)
    assert not verdicts.judge_looked(1.0, cells_near(9), area_near(1.5))
    assert verdicts.awaits_map(4.9) and verdicts.of(7).ready_at > 4.9
    assert not verdicts.judge_looked(1.1, cells_near(9), area_near(1.5))
    assert not verdicts.awaits_map(1.2) and verdicts.of(7).ready_at <= 1.2


def test_a_look_does_not_wait_for_ever_for_a_map() -> None:
    verdicts = known(POINT)
    verdicts.look(POINT.number, lambda _: False, area_near(1.0), 1.0)
    assert verdicts.of(7).ready_at == 1.0 + 8.0


def test_visited_after_two_looks_and_a_younger_map() -> None:
    verdicts = known(POINT)
    for now in (0.0, 2.0):
        verdicts.look(POINT.number, lambda _: False, area_near(now), now)
        verdicts.look(POINT.number, lambda _: False, area_near(now), now + 0.1)
        assert not verdicts.judge_looked(now, cells_near(9), area_near(now + 1.0))
        assert verdicts.judge_looked(now + 0.2, cells_near(9), area_near(now + 1.0)) == (now == 2.0)
    assert verdicts.of(7).visited and not verdicts.is_goal(7)


@pytest.mark.parametrize("target, shown, visited", [(7, 1.1, True), (7, 1.3, False), (None, 1.1, False)])
def test_one_look_in_vain_from_its_own_viewpoint_is_enough(target: Optional[int], shown: float, visited: bool) -> None:
    """Robots left a niche that no look could clear, and came back for the second look."""
    verdicts = known(POINT)
    verdicts.look(target, everything, area_near(1.0), 0.0)
    assert verdicts.judge_looked(1.0, cells_near(9), area_near(shown)) == visited


@pytest.mark.parametrize("offset, inherits", [(0.15, True), (0.25, False)])
def test_a_point_found_anew_where_one_was_visited_is_visited(offset: float, inherits: bool) -> None:
    verdicts = known(POINT)
    look_until_visited(verdicts)
    verdicts.follow([], [POINT])
    verdicts.follow([Frontier(8, 1.0 + offset, 2.0)], [])
    assert verdicts.of(8).visited == inherits
    assert verdicts.of(8).looks == 0


def test_a_given_up_point_that_flickers_is_revived_by_a_changed_map_a_bounded_number_of_times() -> None:
    """It comes back under another number each time."""
    verdicts, point, revived = known(POINT), POINT, 0
    for number in range(8, 20):
        for now in (0.0, 10.0):
            verdicts.fail(point.number, (), False, cells_near(100), now)
        assert verdicts.of(point.number).given_up
        verdicts.follow([], [point])
        point = Frontier(number, POINT.x + 0.05, POINT.y)
        verdicts.follow([point], [])
        assert verdicts.of(number).given_up
        verdicts.revive_changed(cells_near(200))
        revived += not verdicts.of(number).given_up
    assert revived == 3


def test_failures_reach_as_far_as_the_robot_tries() -> None:
    near, far = Frontier(8, 1.4, 2.0), Frontier(9, 1.6, 2.0)
    verdicts = known(POINT, near, far)
    for now in (0.0, 10.0):
        verdicts.fail(7, (), False, cells_near(100), now)
    assert [verdicts.of(number).given_up for number in (7, 8, 9)] == [True, True, False]
    assert verdicts.given_up() == 2


def test_failures_reach_what_is_behind_the_same_block() -> None:
    verdicts = known(POINT, Frontier(8, 9.0, 2.0), Frontier(9, 9.0, 4.0))
    for now in (0.0, 10.0):
        verdicts.fail(7, (8,), False, cells_near(100), now)
    assert [verdicts.of(number).given_up for number in (7, 8, 9)] == [True, True, False]


def test_behind_a_robot_three_failures_count_as_one() -> None:
    verdicts = known(POINT)
    outcomes: List[bool] = []
    for now in range(6):
        verdicts.fail(7, (), True, cells_near(100), float(now))
        outcomes.append(verdicts.of(7).given_up)
    assert outcomes == [False] * 5 + [True]


def test_revived_when_the_map_changes_three_times_at_most() -> None:
    verdicts = known(POINT)
    revivals = 0
    for cells in range(0, 1000, 100):
        verdicts.fail_cluster(1, [7], limit=1, known_near=cells_near(cells))
        verdicts.revive_changed(cells_near(cells + 20))
        assert verdicts.of(7).given_up, "20 cells are no change"
        verdicts.revive_changed(cells_near(cells + 21))
        revivals += not verdicts.of(7).given_up
    assert revivals == 3


def test_one_last_try_before_the_end() -> None:
    verdicts = known(POINT)
    verdicts.fail_cluster(1, [7], limit=1, known_near=cells_near(0))
    assert verdicts.revive_once() and verdicts.is_goal(7)
    verdicts.fail(7, (), False, cells_near(0), 0.0)
    assert not verdicts.is_goal(7) and not verdicts.revive_once()


def test_failures_of_a_cluster_end_with_it() -> None:
    verdicts = known(POINT)
    verdicts.fail_cluster(1, [7], limit=2, known_near=cells_near(0))
    verdicts.follow_clusters([])
    verdicts.fail_cluster(1, [7], limit=2, known_near=cells_near(0))
    assert verdicts.is_goal(7)


CHANGES: Dict[str, Callable[[Verdicts, int, float], object]] = {
    "look": lambda verdicts, number, now: verdicts.look(number, lambda _: False, area_near(1.0), now),
    "judge": lambda verdicts, number, now: verdicts.judge_looked(now, cells_near(9), area_near(1.0)),
    "fail": lambda verdicts, number, now: verdicts.fail(number, (), bool(number), cells_near(9), now),
    "fail cluster": lambda verdicts, number, now: verdicts.fail_cluster(1, [number], 2, cells_near(9)),
    "revive": lambda verdicts, number, now: verdicts.revive_changed(cells_near(99)),
    "revive once": lambda verdicts, number, now: verdicts.revive_once(),
    "nothing": lambda verdicts, number, now: None,
}


@given(st.lists(st.tuples(st.sampled_from(sorted(CHANGES)), st.integers(0, 2), st.floats(0.0, 6.0)), max_size=30))
def test_what_is_ready_holds_until_a_verdict_or_the_time_changes_it(changes: List[Tuple[str, int, float]]) -> None:
    verdicts, now = known(*(Frontier(number, float(number), 0.0) for number in range(3))), 0.0
    ready = verdicts.ready(range(3), now)
    for change, number, pause in changes:
        now += pause
        CHANGES[change](verdicts, number, now)
        anew = verdicts.ready(range(3), now)
        if ready.holds(verdicts, now):
            assert ready.numbers == anew.numbers
        assert anew.numbers == {number for number in range(3) if verdicts.of(number).ready_at <= now}
        ready = anew if number else ready


def test_what_others_tell_is_believed_for_a_while_and_bounded() -> None:
    verdicts = Verdicts()
    for number in range(3000):
        verdicts.believe_explored("robot_1", float(number), 0.0, now=0.0)
    places, robots = verdicts.told_places(7.9)
    assert len(places) == len(robots) == 2000 and places[0][0] == 1000.0 and robots[0] == "robot_1"
    assert not verdicts.told_expired(7.9) and verdicts.told_expired(8.0)
    assert verdicts.told_places(8.0)[0].shape == (0, 2)
