"""Frontier cells, thinning, identity over time, foreign frontiers."""

import math
from typing import Any, List, Tuple

import numpy as np
import pytest
from conftest import drawn, map_of
from hypothesis import given, settings
from hypothesis import strategies as st

from explorer.foreign import REMEMBERED_ROBOTS, Element, ForeignFrontiers, rigid_transform
from explorer.frontier_map import frontier_cells
from explorer.frontiers import THINNING_DISTANCE, FrontierStore, thin

HALL = ["############", "#......     ", "#......     ", "#......     ", "############"]


def test_frontier_is_the_free_edge_next_to_the_unknown() -> None:
    occupancy = drawn(HALL, scale=10)
    cells = frontier_cells(occupancy, 0.4)
    rows, cols = np.nonzero(cells)
    assert set(cols) == {69}
    # Not in the corners: cells with an occupied neighbour do not count.
    assert rows.min() == 11 and rows.max() == 38


def test_noise_is_ignored() -> None:
    cells = np.zeros((60, 60), dtype=np.int8)
    cells[10, 10] = -1
    cells[30:50, 30:50] = -1
    found = frontier_cells(map_of(cells, 0.05), 0.4)
    assert not found[5:15, 5:15].any()
    assert found[29, 35]
    assert not frontier_cells(map_of(cells, 0.05), 50.0).any()


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_frontier_cells_match_their_definition(seed: int) -> None:
    random = np.random.default_rng(seed)
    cells = random.choice(np.array([0, 0, 0, 100, -1], dtype=np.int8), size=(12, 12))
    found = frontier_cells(map_of(cells, 0.5), 0.0)
    for row in range(12):
        for col in range(12):
            near = cells[max(0, row - 1) : row + 2, max(0, col - 1) : col + 2]
            expected = cells[row, col] == 0 and (near == -1).any() and not (near == 100).any()
            assert found[row, col] == expected


@given(st.lists(st.tuples(st.floats(-5, 5), st.floats(-5, 5)), max_size=60))
def test_thinning_covers_all_and_keeps_them_apart(points: list) -> None:
    kept = thin(np.array(points).reshape(-1, 2))
    for x, y in points:
        assert any(abs(x - u) < THINNING_DISTANCE and abs(y - v) < THINNING_DISTANCE for u, v in kept)
    for i in range(len(kept)):
        for j in range(i):
            assert max(abs(kept[i] - kept[j])) >= THINNING_DISTANCE


def test_numbers_persist_while_the_frontier_does() -> None:
    store = FrontierStore(first_number=20000)
    before = drawn(HALL, scale=10)
    new, gone = store.update(before, frontier_cells(before, 0.4))
    assert [f.number for f in new] == list(range(20000, 20000 + len(new))) and not gone
    new, gone = store.update(before, frontier_cells(before, 0.4))
    assert not new and not gone
    # The same map with its origin moved, as a SLAM map that grows to the left.
    grown = np.full((50, 140), -1, dtype=np.int8)
    grown[:, 20:] = before.cells
    moved = map_of(grown, 0.1, x=-2.0)
    new, gone = store.update(moved, frontier_cells(moved, 0.4))
    assert not new and not gone
    seen = drawn(["############", "#.........  ", "#.........  ", "#.........  ", "############"], scale=10)
    new, gone = store.update(seen, frontier_cells(seen, 0.4))
    assert new and gone and min(f.number for f in new) > max(f.number for f in gone)


def test_foreign_points_follow_a_refined_transform_and_need_one() -> None:
    foreign = ForeignFrontiers()
    foreign.add(Element("robot_1", 7, 1.0, 2.0))
    assert foreign.in_own_frame([("robot_1", 7)]) == []
    foreign.set_transform("robot_1", np.array([[1.0, 0, 10.0], [0, 1.0, 0]]))
    assert foreign.in_own_frame([("robot_1", 7)]) == [(11.0, 2.0)]
    foreign.set_transform("robot_1", np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0]]))
    assert foreign.in_own_frame([("robot_1", 7)]) == [(-2.0, 1.0)]
    foreign.set_transform("robot_1", None)
    assert foreign.places("robot_1") == []


def test_foreign_points_are_bounded() -> None:
    foreign = ForeignFrontiers(maximum_per_robot=10)
    for number in range(100):
        foreign.add(Element("robot_1", number, 0.0, 0.0))
    assert foreign.count() == 10
    foreign.set_transform("robot_1", np.eye(3)[:2])
    assert foreign.in_own_frame([("robot_1", 99)]) == [(0.0, 0.0)]


@given(st.floats(-math.pi, math.pi), st.floats(-30, 30), st.floats(-30, 30))
def test_transform_from_three_points(angle: float, x: float, y: float) -> None:
    points = np.array([(0.0, 0.0), (10.0, 0.0), (0.0, 10.0)])
    c, s = math.cos(angle), math.sin(angle)
    images = points @ np.array([[c, s], [-s, c]]) + (x, y)
    transform = rigid_transform(points, images)
    assert transform is not None
    assert np.allclose(np.hstack([points, np.ones((3, 1))]) @ transform.T, images, atol=1e-9)


@pytest.mark.parametrize("images", [[(0, 0), (20, 0), (0, 20)], [(0, 0), (10, 0), (0, math.nan)]])
def test_transform_that_is_not_rigid_is_refused(images: list) -> None:
    assert rigid_transform(np.array([(0, 0), (10, 0), (0, 10)]), np.array(images)) is None


def test_points_of_a_former_mission_are_gone_also_after_the_robot_was_away() -> None:
    foreign = ForeignFrontiers()
    foreign.set_transform("robot_1", np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]))
    foreign.add(Element("robot_1", 7, 1.0, 2.0))
    foreign.take_mission("robot_1", 5)
    foreign.take_mission("robot_1", 5)
    assert foreign.places("robot_1") == [(1.0, 2.0)]
    foreign.take_mission("robot_1", 6)
    assert foreign.places("robot_1") == []


@given(st.lists(st.tuples(st.integers(0, 5), st.booleans(), st.floats(-2, 2), st.floats(-2, 2)), max_size=30))
def test_what_is_near_is_told_from_the_points_that_are_there_now(changes: List[Tuple[int, bool, float, float]]) -> None:
    foreign, points = ForeignFrontiers(), {}
    for number, stays, x, y in changes:
        if stays:
            foreign.add(Element("robot_1", number, x, y))
            points[number] = (x, y)
        else:
            foreign.remove(("robot_1", number))
            points.pop(number, None)
        near = any(math.hypot(px - 0.5, py) <= 0.7 for px, py in points.values())
        assert foreign.have_near([Element("robot_2", 9, 0.5, 0.0), Element("robot_1", 9, 0.5, 0.0)], 0.7) == [
            False,
            near,
        ]


ROBOTS = st.sampled_from(["robot_1", "robot_2"])
CHANGES = st.one_of(
    st.tuples(st.just("add"), ROBOTS, st.integers(0, 4), st.floats(-2, 2)),
    st.tuples(st.just("remove"), ROBOTS, st.integers(0, 4)),
    st.tuples(st.just("place"), ROBOTS, st.none() | st.floats(-9, 9)),
    st.tuples(st.just("mission"), ROBOTS, st.integers(0, 1)),
)


@given(st.lists(CHANGES, max_size=30))
def test_places_in_the_own_frame_follow_every_change(changes: list) -> None:
    def change(foreign: ForeignFrontiers, kind: str, robot: str, *what: Any) -> None:
        if kind == "add":
            foreign.add(Element(robot, what[0], what[1], 1.0))
        elif kind == "remove":
            foreign.remove((robot, what[0]))
        elif kind == "place":
            foreign.set_transform(robot, None if what[0] is None else np.array([[0, -1.0, what[0]], [1.0, 0, 2.0]]))
        else:
            foreign.take_mission(robot, what[0])

    keys = [(robot, number) for robot in ("robot_1", "robot_2") for number in range(5)]
    asked = ForeignFrontiers(maximum_per_robot=3)
    for count, each in enumerate(changes, start=1):
        change(asked, *each)
        anew = ForeignFrontiers(maximum_per_robot=3)
        for former in changes[:count]:
            change(anew, *former)
        assert asked.in_own_frame(keys) == anew.in_own_frame(keys)


def test_any_number_of_robots_takes_bounded_memory() -> None:
    foreign = ForeignFrontiers()
    for number in range(REMEMBERED_ROBOTS + 50):
        foreign.take_mission(f"robot_{number}", 1)
        foreign.add(Element(f"robot_{number}", 0, 1.0, 1.0))
    assert len(foreign._missions) == len(foreign.robots()) == foreign.count() == REMEMBERED_ROBOTS
    assert foreign.robots()[-1] == "robot_99"
