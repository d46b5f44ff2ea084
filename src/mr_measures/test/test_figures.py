"""Figures of maps and motion that are known."""

import numpy as np
import pytest

from mr_grid import IDENTITY, OccupancyGrid, Pose
from mr_measures import figures as m
from mr_measures.truth import KnowableArea, Truth

RESOLUTION = 0.05  # m


def room(width=4.0, height=3.0):
    """Walls one cell thick around an empty room with its lower left outer corner at (0, 0)."""
    cells = np.zeros((round(height / RESOLUTION), round(width / RESOLUTION)), dtype=np.int8)
    cells[0, :] = cells[-1, :] = cells[:, 0] = cells[:, -1] = 100
    return OccupancyGrid.of(cells, RESOLUTION)


def truth_of(walls):
    """All that is free two cells and more from a wall can be known."""
    knowable = walls.cells == 0
    knowable[:3], knowable[-3:], knowable[:, :3], knowable[:, -3:] = False, False, False, False
    return Truth(walls, (), (), 0.0, lambda *_: np.empty(0), KnowableArea(np.empty((0, 2)), knowable))


def map_of(walls, start=IDENTITY):
    """The complete and perfect map of a robot that began at `start`: its frame has the origin there."""
    return OccupancyGrid.of(walls.cells.copy(), walls.resolution, start.inverse())


@pytest.mark.parametrize("start", [Pose(0.0, 0.0, 0.0), Pose(1.0, 1.0, 0.0), Pose(1.0, 1.0, 2.0), Pose(2.0, 0.7, -0.5)])
def test_perfect_map_has_full_coverage_and_no_wrong_walls(start):
    truth, occupancy = truth_of(room()), map_of(room(), start)
    assert m.coverage(truth, occupancy, start) == 1.0
    assert m.wrong_walls(truth, occupancy, start) == 0.0


def test_coverage_is_the_known_share():
    truth, occupancy = truth_of(room()), map_of(room())
    occupancy.cells[:, :40] = -1
    assert m.coverage(truth, occupancy, Pose(0, 0, 0)) == pytest.approx(0.5)
    empty = OccupancyGrid.of(np.full((1, 1), -1, dtype=np.int8), 0.05)
    assert m.coverage(truth, empty, Pose(0, 0, 0)) == 0.0 and m.wrong_walls(truth, empty, Pose(0, 0, 0)) == 0.0


def test_larger_or_smaller_map_with_another_lattice():
    truth, data = truth_of(room()), np.zeros((40, 100), dtype=np.int8)
    half = OccupancyGrid.of(data, 0.1, Pose(-3.0, -2.5, 0.0))  # x from -3 to 7, y from -2.5 to 1.5
    assert m.coverage(truth, half, Pose(0, 0, 0)) == pytest.approx(27 / 54)


def test_misplaced_map_has_wrong_walls():
    truth, occupancy = truth_of(room()), map_of(room())
    assert m.wrong_walls(truth, occupancy, Pose(0.1, 0.0, 0.0)) == 0.0, "within the tolerance of 0.15 m"
    share = m.wrong_walls(truth, occupancy, Pose(0.3, 0.0, 0.0))
    assert share == pytest.approx((58 + 58) / 276, abs=0.02), "left and right wall are off, upper and lower slide along"


@pytest.mark.parametrize("width", [80, 200, 1216, 1536])
def test_walls_drawn_just_the_tolerance_off_are_right_on_maps_of_any_size(width):
    """Rounding had the same cells right or wrong by where the map began: 1.3 % or 2.9 % of a large one."""
    start = Pose(0.375, 0.675, 0.0)
    cells = np.full((60, width), -1, dtype=np.int8)
    cells[20:50, [width - 76, width - 4]] = 100  # 0.2 m and 3.8 m of a room from 0.05 m to 3.95 m
    drawn = OccupancyGrid.of(cells, RESOLUTION, Pose((72 - width) * RESOLUTION, -1.0, 0.0))
    assert m.wrong_walls(truth_of(room()), drawn, start) == 0.0


def test_occupied_cells_far_outside_the_world_are_wrong():
    occupancy = OccupancyGrid.of(np.full((1, 1), 100, dtype=np.int8), 0.05, Pose(50.0, 50.0, 0.0))
    assert m.wrong_walls(truth_of(room()), occupancy, Pose(0, 0, 0)) == 1.0


def test_values_of_a_map():
    occupancy = OccupancyGrid.of(np.array([[-1, 0, 49, 50, 65, 100]], dtype=np.int8), 0.05)
    assert m.explored_free_cells(occupancy) == 2


def test_world_without_free_space_is_refused():
    grid = room()
    grid.cells[:] = 100
    with pytest.raises(ValueError, match="no reference cells"):
        m.coverage(truth_of(grid), map_of(grid), Pose(0, 0, 0))


def test_map_error_is_signed():
    assert m.map_error(1030, 1000.0) == pytest.approx(3.0)
    assert m.map_error(970, 1000.0) == pytest.approx(-3.0)
    with pytest.raises(ValueError, match="must be positive"):
        m.map_error(1, 0.0)


def test_overlap_between_robots():
    a = np.array([True, True, True, False])
    b = np.array([False, False, True, True])
    assert m.overlap_between_robots([a, b]) == pytest.approx(5 / 4 - 1)
    assert m.overlap_between_robots([a]) == 0.0
    assert m.overlap_between_robots([np.zeros(3, dtype=bool)]) == 0.0


def test_slow_turn_is_no_motion_and_a_fast_one_is():
    records = np.zeros(2, dtype=[("time", "f8"), ("v", "f8"), ("w", "f8")])
    records["time"], records["w"] = (1.0, 2.0), (0.09, -0.11)
    assert m.moving_share(records, 0.0, 5.0) == 0.5


def test_contacts_of_both_kinds_are_told_apart():
    records = np.zeros(8, dtype=[("time", "f8"), ("collision", "u1")])
    records["collision"] = (1, 1, 2, 0, 0, 2, 2, 1)
    hits = m.collisions(records)
    assert (hits.with_walls, hits.with_robots) == (2, 2)
