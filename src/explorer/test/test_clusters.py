"""Clusters by the distances of the contract, their numbers, and matching with 40 % of the elements."""

import numpy as np
import pytest
from conftest import drawn, map_of
from hypothesis import given
from hypothesis import strategies as st

from explorer.clusters import Cluster, ClusterStore, group, split_long
from explorer.foreign import Element, ForeignFrontiers
from explorer.frontiers import Frontier
from explorer.recognition import Recognition, listed


def frontiers(*points: tuple, first: int = 0) -> list:
    return [Frontier(first + i, x, y) for i, (x, y) in enumerate(points)]


@pytest.mark.parametrize(
    "points, clusters",
    [
        ([(0, 0), (0.7, 0.7)], 1),
        ([(0, 0), (0.9, 0), (1.6, 0)], 1),
        ([(0, 0), (0.5, 0), (1.4, 0), (1.9, 0)], 2),
        ([(0, 0), (0.5, 0), (1.4, 0)], 1),
        ([(0, 0), (1.1, 0)], 2),
        ([], 0),
        ([(3, 3)], 1),
    ],
)
def test_distances_of_the_contract(points: list, clusters: int) -> None:
    """0.8 m joins clusters, 1 m joins a single point, measured in x and y apart."""
    assert len(set(group(np.array(points, dtype=float).reshape(-1, 2)))) == clusters


@given(st.lists(st.tuples(st.floats(0, 6), st.floats(0, 6)), min_size=1, max_size=40))
def test_points_of_two_clusters_are_never_close(points: list) -> None:
    array = np.array(points)
    labels = group(array)
    assert sorted(set(labels)) == list(range(len(set(labels))))
    for i in range(len(array)):
        for j in range(i):
            if np.abs(array[i] - array[j]).max() < 0.8:
                assert labels[i] == labels[j]


def test_a_wall_separates() -> None:
    occupancy = drawn(["..#..", "..#..", "..#.."], scale=5)
    points = np.array([(0.8, 0.8), (1.7, 0.8)])
    points[1, 0] = 1.55
    assert len(set(group(points))) == 1
    assert len(set(group(points, occupancy))) == 2


def test_long_clusters_are_cut() -> None:
    points = np.column_stack([np.arange(0, 20, 0.5), np.zeros(40)])
    labels = split_long(points, group(points), longest=8.0)
    assert len(set(labels)) == 3
    for label in set(labels):
        assert np.ptp(points[labels == label, 0]) <= 8.0


def test_clusters_keep_their_numbers() -> None:
    occupancy = map_of(np.zeros((100, 100)))
    store = ClusterStore(first_number=10000)
    a, b = frontiers((1, 1), (1.5, 1)), frontiers((8, 8), (8.5, 8), first=10)
    first = store.update(a + b, occupancy)
    assert [c.number for c in first] == [10000, 10001]
    second = store.update(b + a[1:], occupancy)
    by_number = {c.number: c.numbers for c in second}
    assert by_number == {10000: {1}, 10001: {10, 11}}
    third = store.update(frontiers((5, 5), first=50), occupancy)
    assert [c.number for c in third] == [10002]


def shifted_listing(count: int, share: float, shift: float) -> tuple:
    """An own cluster of `count` points, and the keys of another robot's points next to that share of them."""
    own = Cluster(1, tuple(frontiers(*[(0.5 * i, 0.0) for i in range(count)])))
    foreign = ForeignFrontiers()
    foreign.set_transform("robot_1", np.array([[1.0, 0, -20.0], [0, 1.0, 0]]))
    keys = []
    for i in range(round(count * share)):
        foreign.add(Element("robot_1", 10000 + i, 20.0 + 0.5 * i + shift, 0.0))
        keys.append(("robot_1", 10000 + i))
    return own, foreign, keys


def test_more_than_forty_percent_match() -> None:
    own, foreign, keys = shifted_listing(10, 0.3, 0.0)
    # Three listed points cover themselves and the next point within the matching distance: four of ten.
    assert Recognition([own]).match(listed(keys, foreign, "robot_0")) is None
    own, foreign, keys = shifted_listing(10, 0.4, 0.0)
    assert Recognition([own]).match(listed(keys, foreign, "robot_0")) is own


def test_no_match_without_a_transform_or_far_away() -> None:
    own, foreign, keys = shifted_listing(10, 1.0, 0.0)
    foreign.set_transform("robot_1", None)
    assert Recognition([own]).match(listed(keys, foreign, "robot_0")) is None
    own, foreign, keys = shifted_listing(10, 1.0, 0.0)
    foreign.set_transform("robot_1", np.array([[1.0, 0, -27.0], [0, 1.0, 0]]))
    assert Recognition([own]).match(listed(keys, foreign, "robot_0")) is None


def test_own_elements_match_by_key() -> None:
    own = Cluster(1, tuple(frontiers((0, 0), (0.5, 0), (1, 0))))
    foreign = ForeignFrontiers()
    assert Recognition([own]).match(listed([("robot_0", 0), ("robot_0", 2)], foreign, "robot_0")) is own
    assert Recognition([own]).match(listed([("robot_0", 0)], foreign, "robot_0")) is None
    assert Recognition([own]).match(listed([("robot_5", 0), ("robot_5", 1)], foreign, "robot_0")) is None


def test_the_better_match_wins() -> None:
    near, far = Cluster(1, tuple(frontiers((0, 0), (0.5, 0)))), Cluster(2, tuple(frontiers((5, 0), (5.5, 0), first=5)))
    keys = [("robot_0", 0), ("robot_0", 5), ("robot_0", 6)]
    assert Recognition([near, far]).match(listed(keys, ForeignFrontiers(), "robot_0")) is far


def test_other_views_of_a_cluster_leave_what_depends_on_its_members() -> None:
    own = Cluster(3, (Frontier(1, 0.0, 1.0), Frontier(2, 2.0, 3.0)))
    points = own.points
    seen = own.seen(1.5, (0.0, 0.0), 2, 4.0, {2: (0.0, 0.0, 1.5)})
    assert seen == Cluster(3, own.members, 1.5, (0.0, 0.0), 2, 4.0, {2: (0.0, 0.0, 1.5)})
    assert seen.points is points and seen.centre == own.centre and seen.numbers == own.numbers
    assert seen.unseen(4.0) == Cluster(3, own.members, gain=4.0)
