"""Measures on maps and traces whose figures are known."""

import math

import numpy as np
import pytest

from mr_grid import IDENTITY, OccupancyGrid, Pose
from mr_sim import measures as m
from mr_sim.raster import Grid
from mr_sim.trace import TraceError, TraceWriter, read_trace

FOOTPRINT = [((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2))]
STARTS = (Pose(1.0, 1.0, 0.0),)


def room(width=4.0, height=3.0, resolution=0.05):
    """Walls one cell thick around an empty room with its lower left outer corner at (0, 0)."""
    cells = np.zeros((round(height / resolution), round(width / resolution)), dtype=np.uint8)
    cells[0, :] = cells[-1, :] = cells[:, 0] = cells[:, -1] = 1
    return Grid(cells, resolution, (0.0, 0.0))


def truth_of(grid, starts=STARTS, range_max=8.0):
    return m.Truth(grid, starts, FOOTPRINT, range_max)


def map_of(grid, start=IDENTITY):
    """The complete and perfect map of a robot that began at `start`: its frame has the origin there."""
    data = np.where(grid.cells == 1, 100, 0).astype(np.int8)
    c, s = math.cos(-start[2]), math.sin(-start[2])
    corner = Pose(-c * start[0] + s * start[1], -s * start[0] - c * start[1], -start[2])
    return OccupancyGrid.of(data, grid.resolution, corner)


def test_reference_of_an_empty_room_is_all_but_its_margin():
    truth = truth_of(room())
    # Free from 0.05 to 3.95 and 2.95; cell centres at least 0.1 m from the walls: 0.175 ... 3.825 and 2.825.
    assert len(truth.reference) == 74 * 54
    assert truth.reference.min() == pytest.approx(0.175)
    assert truth.reference.max(axis=0) == pytest.approx([3.825, 2.825])


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


def test_occupied_cells_far_outside_the_world_are_wrong():
    occupancy = OccupancyGrid.of(np.full((1, 1), 100, dtype=np.int8), 0.05, Pose(50.0, 50.0, 0.0))
    assert m.wrong_walls(truth_of(room()), occupancy, Pose(0, 0, 0)) == 1.0


def test_values_of_a_map():
    occupancy = OccupancyGrid.of(np.array([[-1, 0, 49, 50, 65, 100]], dtype=np.int8), 0.05)
    assert m.explored_free_cells(occupancy) == 2


def test_world_without_free_space_is_refused():
    grid = room()
    grid.cells[:] = 1
    with pytest.raises(ValueError, match="no reference cells"):
        m.coverage(truth_of(grid), map_of(grid), Pose(0, 0, 0))


def test_footprint_too_wide_in_some_headings_still_passes_in_others():
    grid = room(8.0)
    grid.cells[:, 80:82] = 1
    grid.cells[20:29, 80:82] = 0  # 0.45 m
    long = [((-0.4, -0.15), (0.4, -0.15), (0.4, 0.15), (-0.4, 0.15))]
    truth = m.Truth(grid, [Pose(1.0, 1.5, math.pi / 2)], long, 8.0)
    assert (truth.viewpoints[:, 0] > 5.0).any()


def test_truth_of_a_world(make_world):
    world = make_world(
        'model ( size [ 4 4 1 ] boundary 1 obstacle_return 0 ranger_return -1 )\n'
        'model ( size [ 0.2 4 1 ] pose [ 2 0 0 0 ] ) model ( size [ 0.2 4 1 ] pose [ -2 0 0 0 ] )\n'
        'model ( size [ 4 0.2 1 ] pose [ 0 2 0 0 ] ) model ( size [ 4 0.2 1 ] pose [ 0 -2 0 0 ] )\n'
        'rover ( name "a" )'
    )  # fmt: skip
    truth = m.Truth.of_world(world)
    assert len(truth.reference) == pytest.approx((3.8 - 0.2) ** 2 / 0.05**2, rel=0.03)
    distances = truth.wall_distance(np.array([[0.01, 0.01], [1.95, 0.0], [100.0, 0.0]]))
    assert distances == pytest.approx([1.89, 0.0, math.inf])


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


def test_exploration_time_is_that_of_the_last_robot():
    assert m.exploration_time(10.0, {"a": 100.0, "b": 250.0}) == 240.0
    with pytest.raises(ValueError, match="no robot"):
        m.exploration_time(10.0, {})


@pytest.fixture
def trace(make_world, drive, tmp_path):
    """A robot that drives 1 m in 2 s, stands 1 s, drives into a wall 1 m ahead of it, backs off and hits it again."""
    world = make_world('model ( size [ 0.2 4 1 ] pose [ 2.32 0 0 0 ] )\nrover ( name "a" )')
    path = tmp_path / "trace.csv"
    writer = TraceWriter(path, "test.world", 1, 1.0)

    def run(seconds, linear):
        for _ in range(round(seconds / world.interval)):
            drive(world, world.interval, (linear, 0.0))
            writer.write(world.time, 2 * world.time, "a", world.states()[0])

    for seconds, linear in ((2.0, 0.5), (1.0, 0.0), (3.0, 0.5), (1.0, -0.25), (1.0, 0.5)):
        run(seconds, linear)
    writer.close(world.time, 2 * world.time)
    return path


def test_measures_of_a_trace(trace):
    read = read_trace(trace)
    records = read.robots["a"]
    assert read.real_time_factor == pytest.approx(0.5)
    # The trace begins after the first step of 0.025 m; at 2 m the front stands against the wall's face at 2.22 m.
    assert m.distance_driven(records) == pytest.approx(2.0 - 0.025 + 0.25 + 0.25, abs=0.051)
    assert m.moving_share(records, 0.0, 3.0) == pytest.approx(40 / 60)
    assert m.moving_share(records, 100.0, 200.0) == 0.0
    hits = m.collisions(records)
    assert (hits.with_walls, hits.with_robots, hits.total) == (2, 0, 2)
    assert hits.times[0] == pytest.approx(5.0, abs=0.11) and hits.times[1] == pytest.approx(7.5, abs=0.11)


def test_slow_turn_is_no_motion_and_a_fast_one_is():
    records = np.zeros(2, dtype=[("time", "f8"), ("v", "f8"), ("w", "f8")])
    records["time"], records["w"] = (1.0, 2.0), (0.09, -0.11)
    assert m.moving_share(records, 0.0, 5.0) == 0.5


def test_contacts_of_both_kinds_are_told_apart():
    records = np.zeros(8, dtype=[("time", "f8"), ("collision", "u1")])
    records["collision"] = (1, 1, 2, 0, 0, 2, 2, 1)
    hits = m.collisions(records)
    assert (hits.with_walls, hits.with_robots) == (2, 2)


def test_trace_cut_short_by_a_crash_is_read_up_to_there(trace):
    text = trace.read_text()
    trace.write_text(text[: text.index("\n3.000,")] + "\n3.0")
    read = read_trace(trace)
    assert len(read.robots["a"]) == 59 and read.real_time_factor is None


def test_files_that_are_no_trace(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text("time,x\n")
    with pytest.raises(TraceError, match="not a truth trace"):
        read_trace(path)
    path.write_text("# mr_sim trace 1 seed 0\n1,2,a,b\n")
    with pytest.raises(TraceError, match=r"x\.csv:2: not a row"):
        read_trace(path)
