"""What can be known of simulated worlds whose figures are known."""

import math

import numpy as np
import pytest

from mr_grid import Pose
from mr_measures.truth import Truth
from mr_sim import _world
from mr_sim.raster import Grid
from mr_sim.true_world import occupancy_of, true_world_of

FOOTPRINT = [((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2))]
STARTS = (Pose(1.0, 1.0, 0.0),)


def room(width=4.0, height=3.0, resolution=0.05):
    """Walls one cell thick around an empty room with its lower left outer corner at (0, 0)."""
    cells = np.zeros((round(height / resolution), round(width / resolution)), dtype=np.uint8)
    cells[0, :] = cells[-1, :] = cells[:, 0] = cells[:, -1] = 1
    return Grid(cells, resolution, (0.0, 0.0))


def truth_of(grid, starts=STARTS, range_max=8.0, footprint=FOOTPRINT):
    cast = _world.Raster(grid.cells, grid.resolution, grid.origin).cast
    return Truth(occupancy_of(grid), starts, footprint, range_max, cast)


def test_reference_of_an_empty_room_is_all_but_its_margin():
    truth = truth_of(room())
    # Free from 0.05 to 3.95 and 2.95; cell centres at least 0.1 m from the walls: 0.175 ... 3.825 and 2.825.
    assert len(truth.reference) == 74 * 54
    assert truth.reference.min() == pytest.approx(0.175)
    assert truth.reference.max(axis=0) == pytest.approx([3.825, 2.825])


@pytest.mark.parametrize("place", [(100.0, 100.0), (-1.5, -1.5)])
def test_from_far_outside_the_walls_nothing_is_known(place):
    assert len(truth_of(room(), [Pose(*place)]).viewpoints) == 0
    assert np.array_equal(truth_of(room(), [*STARTS, Pose(*place)]).viewpoints, truth_of(room()).viewpoints)


def test_what_no_robot_can_see_is_no_reference():
    grid = room(8.0)
    grid.cells[:, 80:82] = 1
    assert truth_of(grid).reference[:, 0].max() < 4.0
    grid.cells[20:26, 80:82] = 0  # a gap of 0.3 m: too narrow to drive through, wide enough to look through
    beyond = truth_of(grid).reference
    assert (beyond[:, 0] > 5.0).any() and (beyond[:, 0] > 4.1).sum() < 74 * 54
    grid.cells[20:32, 80:82] = 0  # 0.6 m: the robot passes
    assert (truth_of(grid).reference[:, 0] > 4.1).sum() > 0.97 * 75 * 54


def test_laser_range_limits_the_reference():
    far = truth_of(room(30.0, 1.0), range_max=2.0)
    assert len(far.reference) == len(truth_of(room(30.0, 1.0), range_max=40.0).reference), "the robot drives on"


def test_footprint_too_wide_in_some_headings_still_passes_in_others():
    grid = room(8.0)
    grid.cells[:, 80:82] = 1
    grid.cells[20:29, 80:82] = 0  # 0.45 m
    long = [((-0.4, -0.15), (0.4, -0.15), (0.4, 0.15), (-0.4, 0.15))]
    truth = truth_of(grid, [Pose(1.0, 1.5, math.pi / 2)], footprint=long)
    assert (truth.viewpoints[:, 0] > 5.0).any()


def test_truth_of_a_world(make_world):
    world = make_world(
        'model ( size [ 4 4 1 ] boundary 1 obstacle_return 0 ranger_return -1 )\n'
        'model ( size [ 0.2 4 1 ] pose [ 2 0 0 0 ] ) model ( size [ 0.2 4 1 ] pose [ -2 0 0 0 ] )\n'
        'model ( size [ 4 0.2 1 ] pose [ 0 2 0 0 ] ) model ( size [ 4 0.2 1 ] pose [ 0 -2 0 0 ] )\n'
        'rover ( name "a" )'
    )  # fmt: skip
    truth = Truth.of_world(true_world_of(world))
    assert len(truth.reference) == pytest.approx((3.8 - 0.2) ** 2 / 0.05**2, rel=0.03)
    distances = truth.wall_distance(np.array([[0.01, 0.01], [1.95, 0.0], [100.0, 0.0]]))
    assert distances == pytest.approx([1.89, 0.0, math.inf])
