"""Viewpoints: reachable, in sight, not in inflation, not deep in the unknown; the sensor's field of view."""

import math

import numpy as np
import pytest
from conftest import drawn, map_of

from explorer.clusters import Cluster
from explorer.frontiers import Frontier
from explorer.travel import TravelGrid
from explorer.views import Views, sees
from mr_grid import Pose

HALL = ["############", "#......     ", "#......     ", "#......     ", "############"]


def views_of(occupancy, start: tuple, view_distance: float = 1.5) -> Views:  # type: ignore[no-untyped-def]
    grid = TravelGrid(occupancy, 0.25, 0.6)
    return Views(occupancy, grid.field_from(*start), view_distance)


def test_viewpoint_is_clear_of_walls_and_of_the_unknown() -> None:
    occupancy = drawn(HALL, scale=10)
    view = views_of(occupancy, (2.0, 2.5)).of(np.array([(6.95, 2.5)]))[0]
    assert view is not None
    x, y, cost = view
    assert 5.4 < x <= 6.75 and 1.3 < y < 3.7
    assert cost >= x - 2.0 - 0.1


def test_viewpoint_is_not_behind_a_wall() -> None:
    """The point lies in a closed room, 0.4 m from the hall where the robot is."""
    occupancy = drawn(["##########", "#...#....#", "#...#....#", "#...#....#", "##########"], scale=4)
    cells = occupancy.cells.copy()
    occupancy = map_of(cells)
    views = views_of(occupancy, (0.9, 1.0))
    assert views.of(np.array([(2.1, 1.0)])) == [None]
    assert views.of(np.array([(1.5, 1.0)]))[0] is not None


def test_view_distance_limits() -> None:
    """A point in a gap too narrow for the robot is seen from outside, if that is near enough."""
    cells = np.zeros((60, 100), dtype=np.int8)
    cells[:, 60:] = 100
    cells[28:32, 60:80] = 0
    occupancy = map_of(cells, 0.1)
    point = np.array([(7.4, 3.0)])
    assert views_of(occupancy, (2.0, 3.0), view_distance=1.0).of(point) == [None]
    view = views_of(occupancy, (2.0, 3.0), view_distance=2.5).of(point)[0]
    assert view is not None and view[0] < 6.0


def test_cluster_takes_the_cheapest_place_near_its_middle() -> None:
    occupancy = drawn(HALL, scale=10)
    members = [Frontier(i, 6.95, 1.3 + 0.2 * i) for i in range(13)]
    views = views_of(occupancy, (2.0, 2.5))
    bare = Cluster(1, tuple(members))
    (cluster,) = views.assess([bare], {member.number: member for member in members})
    assert cluster.reachable and cluster.target is not None and cluster.viewpoint is not None
    assert abs(cluster.viewpoint[1] - 2.5) < 0.5
    assert cluster.gain > 4.0
    (cluster,) = views.assess([bare], {})
    assert not cluster.reachable and cluster.viewpoint is None


def test_gain_counts_what_lies_outside_of_the_map() -> None:
    occupancy = map_of(np.zeros((100, 100)), 0.1)
    views = views_of(occupancy, (5.0, 5.0))
    assert views.gain(5.0, 5.0) == 0.0
    assert views.gain(10.0, 5.0) == pytest.approx(4.1 * 2.1, abs=0.5)


def test_field_of_view() -> None:
    occupancy = map_of(np.zeros((100, 100)), 0.1)
    occupied = occupancy.occupied.copy()
    pose = Pose(5.0, 5.0, 0.0)
    behind, ahead = (2.0, 5.0), (8.0, 5.0)
    assert sees(occupied, occupancy.info, pose, 4.71, ahead)
    assert not sees(occupied, occupancy.info, pose, 4.71, behind)
    assert sees(occupied, occupancy.info, pose, 2 * math.pi, behind)
    occupied[:, 65] = True
    assert not sees(occupied, occupancy.info, pose, 4.71, ahead)


def test_views_that_take_over_from_former_ones_are_the_same() -> None:
    """From another place, on another map of the same size, and from a place that reaches other cells."""
    first = drawn(["##########", "#...#....#", "#...#....#", "#...#....#", "##########"], scale=4)
    second = drawn(["##########", "#...#....#", "#...  ...#", "#...#....#", "##########"], scale=4)
    points = np.array([(1.5, 1.0), (0.7, 1.2), (2.6, 1.0), (3.2, 0.9)])
    former = None
    for occupancy, start in [(first, (0.9, 1.0)), (first, (1.1, 0.9)), (second, (1.1, 0.9)), (second, (2.8, 1.0))]:
        field = TravelGrid(occupancy, 0.25, 0.6).field_from(*start)
        fresh, former = Views(occupancy, field, 1.5), Views(occupancy, field, 1.5, former)
        assert former.of(points) == fresh.of(points)
        assert former.gain(2.0, 1.0) == fresh.gain(2.0, 1.0)
