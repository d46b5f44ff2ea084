"""The global map: nothing lost, nothing doubled, nothing opened; the same whatever the order; only changes computed."""

import math

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from map_merger import fusion_benchmark, global_map, weighing
from map_merger.global_map import GlobalMap, Policy
from map_merger.grid import Box, cropped, free_cells, full_box, occupied_cells, offset_between, window
from map_merger.robot_size import USUAL_SIZE
from mr_grid import FREE, OCCUPIED, UNKNOWN, GridInfo, OccupancyGrid, Pose

RESOLUTION = 0.05
POLICIES = [Policy.STRICT, Policy.EVIDENCE]


def room(rows=40, columns=60, x=0.0, y=0.0, yaw=0.0):
    """Free space inside a wall one cell thick."""
    cells = np.zeros((rows, columns), np.int8)
    cells[[0, -1]] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    return OccupancyGrid(GridInfo(columns, rows, RESOLUTION, Pose(x, y, yaw)), cells)


def unknown(rows=80, columns=100, x=-1.0, y=-1.0):
    return OccupancyGrid(GridInfo(columns, rows, RESOLUTION, Pose(x, y)), np.full((rows, columns), UNKNOWN, np.int8))


def grid_like(cells, x=0.0, y=0.0):
    cells = np.asarray(cells, np.int8)
    return OccupancyGrid(GridInfo(cells.shape[1], cells.shape[0], RESOLUTION, Pose(x, y)), cells)


def merged(local, *others, policy=Policy.STRICT, places=()):
    """The rendered map of a local map and (grid, transform) of others, named a, b, ...; `places`: (name, points)."""
    fusion = GlobalMap("own", USUAL_SIZE, policy)
    fusion.set_local(local)
    for number, (grid, transform) in enumerate(others):
        fusion.set_layer("abcdefgh"[number], grid, 0, transform)
    for name, points in places:
        fusion.set_places(name, np.array(points, float).reshape(-1, 2))
    return fusion.render().grid


def cell_of(grid, x, y):
    local = grid.info.origin.inverse().apply_point(x, y)
    return math.floor(local[1] / grid.info.resolution), math.floor(local[0] / grid.info.resolution)


def value_at(grid, x, y):
    return grid.cells[cell_of(grid, x, y)]


def passable(grid, begin, end):
    """True if `end` (m) can be reached from `begin` without crossing obstacles; unknown cells and the outside count as
    open."""
    open_cells = np.pad(grid.cells < 50, 1, constant_values=True).astype(np.uint8)
    _, labels = cv2.connectedComponents(open_cells, connectivity=4)
    return labels[tuple(np.add(cell_of(grid, *begin), 1))] == labels[tuple(np.add(cell_of(grid, *end), 1))]


@pytest.mark.parametrize("jump", [20000.0, 20000.02])
def test_a_local_map_that_jumps_far_away_is_drawn_anew(jump):
    """The cells between were read as well: 150 GB."""
    fusion = GlobalMap("own", USUAL_SIZE, Policy.EVIDENCE)
    fusion.set_local(room())
    fusion.set_layer("a", room(), 0, Pose(0.5, 0.0, 0.0))
    fusion.render()
    fusion.set_local(room(x=jump))
    assert value_at(fusion.render().grid, jump + 1.0, 1.0) == FREE


def pseudo_frontier(grid):
    """Free cells beside unknown ones and not beside obstacles: where an explorer would go."""
    kernel = np.ones((3, 3), np.uint8)
    beside_unknown = cv2.dilate((grid.cells == UNKNOWN).astype(np.uint8), kernel) > 0
    beside_wall = cv2.dilate(occupied_cells(grid).astype(np.uint8), kernel) > 0
    return int((free_cells(grid) & beside_unknown & ~beside_wall).sum())


# Alone, and what comes back


@pytest.mark.parametrize("policy", POLICIES)
def test_alone_it_is_the_local_map(policy):
    local = room()
    fusion = GlobalMap("own", USUAL_SIZE, policy)
    assert fusion.render() is None
    fusion.set_local(local)
    update = fusion.render()
    assert update.grid.info == local.info
    assert np.array_equal(update.grid.cells, local.cells)
    assert update.changed == full_box(local.info)
    fusion.set_layer("a", unknown(), 0, Pose())
    assert fusion.render() is None, "a map that knows nothing changes nothing"


def test_nothing_is_returned_where_nothing_changed():
    fusion = GlobalMap("own", USUAL_SIZE)
    fusion.set_local(room())
    fusion.set_layer("a", room(x=1.0), 1, Pose(0.4, 0.3, 0.2))
    fusion.set_places("a", np.array([[1.0, 1.0], [1.5, 1.0]]))
    assert fusion.render() is not None
    assert fusion.render() is None
    fusion.set_local(room())
    fusion.set_layer("a", room(x=1.0), 1, Pose(0.4, 0.3, 0.2))
    fusion.set_places("a", np.array([[1.0, 1.0], [1.5, 1.01]]))
    assert fusion.render() is None


def test_a_small_refinement_redraws_nothing_and_a_larger_one_does():
    fusion = GlobalMap("own", USUAL_SIZE)
    fusion.set_local(unknown())
    fusion.set_layer("a", room(), 1, Pose(0.024, 0.0, 0.0))
    before = fusion.render().grid
    fusion.set_layer("a", room(), 2, Pose(0.0275, 0.0, math.radians(0.02)))
    assert fusion.render() is None
    fusion.set_layer("a", room(), 3, Pose(0.08, 0.0, 0.0))
    assert not np.array_equal(fusion.render().grid.cells, before.cells)


def test_published_maps_are_not_changed_afterwards():
    fusion = GlobalMap("own", USUAL_SIZE)
    fusion.set_local(room())
    published = fusion.render().grid
    copy = published.cells.copy()
    changed = room()
    changed.cells[10, 10] = OCCUPIED
    fusion.set_local(changed)
    assert fusion.render().changed == Box(10, 10, 11, 11)
    assert np.array_equal(published.cells, copy)


def test_a_removed_layer_leaves_nothing():
    fusion = GlobalMap("own", USUAL_SIZE)
    fusion.set_local(room())
    before = fusion.render().grid
    fusion.set_layer("a", room(), 0, Pose(1.0, 1.0, 0.5))
    assert fusion.render().grid.info != before.info
    fusion.remove_layer("a")
    fusion.remove_layer("never there")
    after = fusion.render().grid
    assert after.info == before.info
    assert np.array_equal(after.cells, before.cells)


def test_layers_with_which_the_map_would_be_too_large_are_left_out(monkeypatch):
    monkeypatch.setattr(global_map, "MOST_GLOBAL_CELLS", 100 * 100)
    fusion = GlobalMap("own", USUAL_SIZE)
    fusion.set_local(room())
    fusion.set_layer("far", room(), 0, Pose(90.0, 0.0, 0.0))
    fusion.set_layer("near", room(), 0, Pose(1.0, 0.0, 0.0))
    assert fusion.render().grid.info.width == 80
    assert fusion.left_out == ("far",)
    fusion.set_layer("far", room(), 1, Pose(0.0, 1.0, 0.0))
    assert fusion.render().grid.info.shape == (60, 80)
    assert fusion.left_out == ()


def test_a_coarse_map_of_a_large_place_is_left_out_before_it_is_drawn(monkeypatch):
    monkeypatch.setattr(global_map, "MOST_GLOBAL_CELLS", 100 * 100)
    coarse = OccupancyGrid(GridInfo(500, 500, 100.0), np.zeros((500, 500), np.int8))
    fusion = GlobalMap("own", USUAL_SIZE)
    fusion.set_local(room())
    fusion.set_layer("coarse", coarse, 0, Pose(0.0, 0.0, 0.5))
    assert fusion.render().grid.info == room().info
    assert fusion.left_out == ("coarse",)
    fusion.set_layer("coarse", room(), 1, Pose(0.0, 0.0, 0.5))
    fusion.render()
    assert fusion.left_out == ()


def test_bad_calls_are_refused():
    fusion = GlobalMap("own", USUAL_SIZE)
    with pytest.raises(ValueError, match="own is the local one"):
        fusion.set_layer("own", room(), 0, Pose())
    for places in (np.zeros((2, 3)), np.array([[0.0, math.nan]])):
        with pytest.raises(ValueError, match="places are finite numbers"):
            fusion.set_places("a", places)


# The contract


@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-math.pi, math.pi))
def test_strict_keeps_known_local_cells_and_the_lattice_of_the_local_map(x, y, yaw):
    local = room(x=-0.3, y=0.7)
    result = merged(local, (room(), Pose(x, y, yaw)), (room(), Pose(y, x, -yaw)))
    row, column = offset_between(local.info, result.info)
    part = result.cells[row : row + local.info.height, column : column + local.info.width]
    assert np.array_equal(part, local.cells)
    assert result.info.resolution == local.info.resolution
    shift = result.info.origin.inverse().compose(local.info.origin)
    assert shift.x / RESOLUTION == pytest.approx(round(shift.x / RESOLUTION), abs=1e-6)


@given(st.integers(0, 2**32 - 1))
def test_strict_keeps_any_known_local_cell(seed):
    local, *others = noisy_maps(np.random.default_rng(seed), 3)
    result = cropped(merged(local, *[(grid, Pose()) for grid in others]), full_box(local.info))
    known = local.cells != UNKNOWN
    assert np.array_equal(result.cells[known], local.cells[known])


# Walls


@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-math.pi, math.pi))
def test_foreign_walls_stay_closed_and_thin_at_any_angle(x, y, yaw):
    transform = Pose(x, y, yaw)
    result = merged(unknown(200, 200, -5.0, -5.0), (room(), transform))
    assert not passable(result, transform.apply_point(1.5, 1.0), (-4.9, -4.9)), "the wall has a gap"
    assert occupied_cells(result).sum() <= 1.25 * occupied_cells(room()).sum(), "the wall became thicker"


@given(st.floats(0.0, math.pi / 2))
def test_walls_that_hang_together_at_corners_only_stay_closed(yaw):
    cells = np.full((41, 41), UNKNOWN, np.int8)
    rows, columns = np.mgrid[0:41, 0:41]
    distance = abs(rows - 20) + abs(columns - 20)
    cells[distance < 15] = FREE
    cells[distance == 15] = OCCUPIED
    transform = Pose(0.013, -0.007, yaw)
    result = merged(unknown(200, 200, -5.0, -5.0), (grid_like(cells), transform))
    assert not passable(result, transform.apply_point(1.0, 1.0), (-4.9, -4.9))


def test_thin_walls_of_a_finer_map_stay_closed():
    cells = np.zeros((160, 200), np.int8)
    cells[[0, -1]] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    fine = OccupancyGrid(GridInfo(200, 160, 0.0125, Pose()), cells)
    result = merged(unknown(200, 200, -5.0, -5.0), (fine, Pose(0.3, 0.2, 0.4)))
    assert not passable(result, Pose(0.3, 0.2, 0.4).apply_point(1.2, 1.0), (-4.9, -4.9))


@pytest.mark.parametrize("policy", POLICIES)
@given(
    st.lists(st.tuples(st.floats(-0.05, 0.05), st.floats(-0.05, 0.05), st.floats(-0.01, 0.01)), min_size=2, max_size=4)
)
@settings(max_examples=40)
def test_a_wall_seen_by_several_is_closed_and_not_doubled(policy, poses):
    """Maps of one room, up to a cell off: one wall, without space inside it, without frontiers, and no gap."""
    result = merged(unknown(100, 120, -1.5, -1.5), *[(room(), Pose(*pose)) for pose in poses], policy=policy)
    assert not passable(result, (1.5, 1.0), (-1.4, -1.4)), "the wall has a gap"
    assert pseudo_frontier(result) == 0
    inner = free_cells(result).astype(np.uint8)
    count, _ = cv2.connectedComponents(inner, connectivity=8)
    assert count == 2, "there is space inside the wall"
    assert occupied_cells(result).sum() <= 1.6 * occupied_cells(room()).sum(), "the wall is doubled"


@pytest.mark.parametrize("offset", [0.025, -0.025, 0.05, -0.05])
@pytest.mark.parametrize("first", ["a", "b"])
def test_the_floor_of_one_map_does_not_remove_the_wall_of_another_one_cell_off(offset, first):
    """Each of two robots saw its side of a wall. Whose floor was drawn first used to cut into the other's wall."""
    west = np.full((40, 40), UNKNOWN)
    west[:, :20] = FREE
    west[:, 20] = OCCUPIED
    east = np.full((40, 40), UNKNOWN)
    east[:, 21:] = FREE
    east[:, 20] = OCCUPIED
    maps = [(grid_like(west), Pose()), (grid_like(east), Pose(offset, 0.0, 0.0))]
    result = merged(unknown(40, 40, 0.0, 0.0), *(maps if first == "a" else maps[::-1]))
    for y in np.arange(0.1, 1.9, 0.05):
        row, _ = cell_of(result, 0.0, y)
        assert result.cells[row, 10] == FREE
        assert result.cells[row, 32] == FREE
        walls = np.flatnonzero(result.cells[row] == OCCUPIED)
        assert 1 <= walls.size <= 2
        assert np.ptp(walls) <= 1
    assert pseudo_frontier(cropped(result, Box(0, 5, 40, 35))) == 0


@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("shift", [-0.05, 0.05, 0.08, -0.08])
def test_a_door_that_the_robot_saw_is_not_closed_by_a_wall_one_cell_off(shift, policy):
    local = room(40, 60)
    local.cells[0, 25:45] = FREE
    foreign = OccupancyGrid(GridInfo(60, 35, 0.05, Pose(0.0, -1.45, 0.0)), np.zeros((35, 60), np.int8))
    foreign.cells[29] = OCCUPIED
    foreign.cells[29, 25:45] = FREE
    result = merged(local, (foreign, Pose(shift, shift, 0.0)), policy=policy)
    assert passable(result, (1.5, 1.0), (1.5, -0.5))


@pytest.mark.parametrize("opened_by", [0, 1, 2])
def test_a_door_that_anybody_saw_open_is_open(opened_by):
    maps = [room(40, 60) for _ in range(3)]
    for number, grid in enumerate(maps):
        grid.cells[20] = OCCUPIED
        if number == opened_by:
            grid.cells[20, 20:40] = FREE
    result = merged(unknown(), *[(grid, Pose()) for grid in maps])
    assert passable(result, (1.5, 0.5), (1.5, 1.5))
    assert not passable(result, (1.5, 0.5), (-0.5, -0.5))


@pytest.mark.parametrize("shift", [0.05, -0.05])
def test_a_wall_that_falls_on_local_floor_leaves_neither_opening_nor_frontier(shift):
    """The local map saw the floor up to the wall but not the wall; the foreign wall is one cell off."""
    local = room(40, 60)
    local.cells[-1] = UNKNOWN
    foreign = OccupancyGrid(GridInfo(60, 30, 0.05, Pose(0.0, 1.95, 0.0)), np.zeros((30, 60), np.int8))
    foreign.cells[0] = OCCUPIED
    result = merged(local, (foreign, Pose(0.0, shift, 0.0)))
    assert not passable(result, (1.5, 1.0), (1.5, 2.5))
    foreign.cells[1:] = UNKNOWN
    assert pseudo_frontier(merged(local, (foreign, Pose(0.0, shift, 0.0)))) == 0


@pytest.mark.parametrize("gap", [1, 2])
@pytest.mark.parametrize("policy", POLICIES)
def test_narrow_gaps_between_maps_are_no_frontier(gap, policy):
    """Two robots saw the floor up to a line from both sides."""
    local = grid_like(np.where(np.arange(60) < 30, FREE, UNKNOWN) * np.ones((40, 1)))
    other = grid_like(np.where(np.arange(60) >= 30 + gap, FREE, UNKNOWN) * np.ones((40, 1)))
    result = merged(local, (other, Pose()), policy=policy)
    assert (result.cells[1:-1] == FREE).all()
    wide = grid_like(np.where(np.arange(60) >= 36, FREE, UNKNOWN) * np.ones((40, 1)))
    assert pseudo_frontier(merged(local, (wide, Pose()), policy=policy)) > 0, "unexplored space stays a frontier"


def test_a_gap_of_one_map_by_itself_stays():
    local = grid_like(np.where(np.arange(60) != 30, FREE, UNKNOWN) * np.ones((40, 1)))
    assert (merged(local, (unknown(), Pose())).cells[:, 30] == UNKNOWN).all()


def test_without_shift_the_copy_is_exact_at_another_origin():
    result = merged(unknown(100, 100, -1.0, -1.0), (room(), Pose()))
    assert np.array_equal(result.cells[20:60, 20:80], room().cells)


def test_other_resolutions_are_resampled():
    coarse = OccupancyGrid(GridInfo(10, 10, 0.1), np.full((10, 10), FREE, np.int8))
    coarse.cells[:, 0] = OCCUPIED
    result = merged(unknown(), (coarse, Pose()))
    assert (result.cells == OCCUPIED).sum() == 2 * 20
    assert (result.cells == FREE).sum() == 18 * 20


def test_the_majority_corrects_the_local_map_by_evidence_only():
    local, other = room(), room()
    local.cells[15:22, 30:37] = OCCUPIED
    others = [(other, Pose()), (other, Pose())]
    assert value_at(merged(local, *others, policy=Policy.STRICT), 1.675, 0.925) == OCCUPIED
    assert value_at(merged(local, *others, policy=Policy.EVIDENCE), 1.675, 0.925) == FREE


@pytest.mark.parametrize("locked", [True, False])
@given(st.integers(0, 2**32 - 1), st.integers(0, 130), st.integers(0, 130))
@settings(max_examples=40)
def test_maps_are_weighed_alike_wherever_the_window_begins(locked, seed, left, right):
    """Cells are worked on in words of 64; what lies across the border of two words is one map."""
    maps = [grid.cells for grid in noisy_maps(np.random.default_rng(seed), 3, 40, 60)]
    margin = weighing.reach(2)
    wide = [np.pad(cells, ((margin, margin), (margin + left, margin + right)), constant_values=-1) for cells in maps]
    near = [np.pad(cells, margin, constant_values=-1) for cells in maps]
    result = weighing.weighed(wide[0], wide[1:], locked)
    expected = weighing.weighed(near[0], near[1:], locked)
    assert np.array_equal(result[:, left : left + expected.shape[1]], expected)


# Robots in maps


def smudged(top=18, left=28, rows=8, columns=7):
    """A room with what looks like a robot in it."""
    grid = room()
    grid.cells[top : top + rows, left : left + columns] = OCCUPIED
    return grid


HERE, THERE = (1.575, 1.1), (2.6, 1.6)
"""The middle of the smudge, and a place far from it."""


def test_robots_are_no_obstacles_in_the_maps_of_others():
    places = [("b", [HERE, THERE])]
    result = merged(unknown(), (smudged(), Pose()), places=places)
    assert value_at(result, *HERE) == FREE
    assert (occupied_cells(result).sum(), free_cells(result).sum()) == (
        occupied_cells(room()).sum(),
        free_cells(room()).sum(),
    )


def test_mates_are_removed_from_the_local_map():
    """Robots that started side by side closed each other's way home for ever."""
    local, elsewhere = smudged(), (unknown(), Pose())
    assert value_at(merged(local, elsewhere, places=[("a", [THERE, HERE])]), *HERE) == FREE
    assert value_at(merged(local, elsewhere, places=[("a", [HERE, THERE])]), *HERE) == FREE
    assert value_at(merged(local, elsewhere, places=[("a", [THERE])]), *HERE) == OCCUPIED
    assert value_at(merged(local, elsewhere, places=[("own", [(1.0, 1.1)])]), *HERE) == OCCUPIED


def test_a_pillar_that_the_robot_itself_saw_is_none():
    """The robot drove by closely; it knows that a pillar stands there."""
    beside = (HERE[0] + 0.4, HERE[1])
    places = [("a", [beside, THERE])]
    assert value_at(merged(smudged(), (smudged(), Pose()), places=places), *HERE) == OCCUPIED
    assert value_at(merged(smudged(), (room(), Pose()), places=places), *HERE) == FREE


@pytest.mark.parametrize("policy", POLICIES)
def test_a_robot_beside_a_wall_is_removed_and_the_wall_is_not(policy):
    """Robots that started beside a wall stayed for ever, as their ghosts hung together with it."""
    local = smudged(top=1)
    other = room()
    places = [("a", [(1.575, 0.25), THERE])]
    result = merged(local, (other, Pose()), places=places, policy=policy)
    assert value_at(result, 1.575, 0.3) == FREE
    assert (cropped(result, full_box(local.info)).cells[0] == OCCUPIED).all()
    assert not passable(result, (1.5, 1.0), (1.5, -0.5)) or result.info.height == 40


def test_where_the_own_robot_drove_there_is_no_wall():
    local = room()
    local.cells[18:21, 10:50] = OCCUPIED
    result = merged(local, (unknown(), Pose()), places=[("own", [(1.525, 0.6), (1.525, 0.975), (1.525, 1.4)])])
    assert value_at(result, 1.525, 0.975) == FREE
    assert value_at(result, 1.0, 0.975) == OCCUPIED


# Incremental


def noisy_maps(random, count, rows=70, columns=90):
    """Maps of the same building, each known in parts only, with walls off by a cell here and there."""
    truth = np.zeros((rows, columns), np.int8)
    for _ in range(4):
        truth[random.integers(rows)] = OCCUPIED
        truth[:, random.integers(columns)] = OCCUPIED
    for _ in range(6):
        row, column = random.integers(rows), random.integers(columns)
        truth[row : row + 14, column : column + 14] = FREE
    maps = []
    for _ in range(count):
        cells = np.roll(truth, random.integers(-2, 3, 2), (0, 1))
        for _ in range(5):
            row, column = random.integers(rows), random.integers(columns)
            cells[row : row + random.integers(30), column : column + random.integers(30)] = UNKNOWN
        cells[random.random(cells.shape) < 0.02] = OCCUPIED
        maps.append(grid_like(cells))
    return maps


def operations(random, count, spread):
    """Calls of GlobalMap, (method, arguments): maps that change and grow, new transforms, places, removals. `spread`: m
    that maps lie apart at most, along each axis."""

    def transform():
        return Pose(*random.uniform(-spread, spread, 2), *random.uniform(-1.0, 1.0, 1))

    maps = dict(zip(["own", "a", "b", "c"], noisy_maps(random, 4)))
    versions, calls = dict.fromkeys(maps, 0), []
    places = {name: np.empty((0, 2)) for name in maps}
    transforms = {name: transform() for name in maps}
    calls.append(("set_local", (maps["own"],)))
    for _ in range(count):
        name = str(random.choice(list(maps)))
        kind = random.choice(["cells", "grow", "places", "remove", "turn", "back"], p=[0.4, 0.15, 0.2, 0.1, 0.1, 0.05])
        grid, changed = maps[name], None
        if kind in ("cells", "back"):
            top, left = random.integers(0, grid.info.height - 8), random.integers(0, grid.info.width - 8)
            changed = Box(int(top), int(left), int(top) + 8, int(left) + 8)
            cells = grid.cells.copy()
            cells[changed.slices()] = random.choice([UNKNOWN] if kind == "back" else [UNKNOWN, FREE, OCCUPIED], (8, 8))
            maps[name] = OccupancyGrid(grid.info, cells)
        elif kind == "grow":
            top, left = (-int(value) for value in random.integers(0, 9, 2))
            maps[name] = cropped(grid, Box(top, left, grid.info.height + 3, 95))
        elif kind == "places":
            places[name] = np.concatenate([places[name], random.uniform(-1.0, 5.0, (3, 2))])[-8:]
            calls.append(("set_places", (name, places[name])))
            continue
        elif name == "own":
            continue
        elif kind == "remove":
            calls.append(("remove_layer", (name,)))
            continue
        else:
            transforms[name] = transform()
        versions[name] += 1
        if name == "own":
            calls.append(("set_local", (maps[name],)))
        else:
            told = changed if any(call[0] == "set_layer" and call[1][0] == name for call in calls[-1:]) else None
            calls.append(("set_layer", (name, maps[name], versions[name], transforms[name], told)))
    return calls


def last_state(calls):
    """The calls that count in the end, last of each kind and robot."""
    state = {}
    for method, arguments in calls:
        key = (method, arguments[0]) if method != "set_local" else ("set_local", "own")
        if method == "remove_layer":
            state.pop(("set_layer", arguments[0]), None)
            continue
        state[key] = (method, (*arguments[:4], None) if method == "set_layer" else arguments)
    return list(state.values())


@pytest.mark.parametrize("policy", POLICIES)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1.0, 6.0]))
@settings(max_examples=40)
def test_step_by_step_or_at_once_in_any_order_the_map_is_the_same(policy, seed, spread):
    random = np.random.default_rng(seed)
    calls = operations(random, 25, spread)
    stepwise, shown = GlobalMap("own", USUAL_SIZE, policy), None
    for method, arguments in calls:
        getattr(stepwise, method)(*arguments)
        update = stepwise.render() if random.random() < 0.5 else None
        if update is not None:
            if shown is not None and shown.info == update.grid.info:
                outside = shown.cells != update.grid.cells
                outside[update.changed.slices()] = False
                assert not outside.any(), "cells changed outside the box that was told"
            shown = update.grid
    last = stepwise.render()
    shown = shown if last is None else last.grid
    state = last_state(calls)
    at_once = GlobalMap("own", USUAL_SIZE, policy)
    for number in random.permutation(len(state)):
        getattr(at_once, state[number][0])(*state[number][1])
    expected = at_once.render().grid
    assert shown.info.shape == expected.info.shape
    assert np.array_equal(shown.cells, expected.cells)


def test_one_changed_tile_computes_the_tiles_around_it_only(monkeypatch):
    computed = []
    weigh = weighing.weighed
    monkeypatch.setattr(
        weighing, "weighed", lambda local, *others: computed.append(local.size) or weigh(local, *others)
    )
    fusion = GlobalMap("own", USUAL_SIZE)
    fusion.set_local(unknown(1200, 1200))
    fusion.set_layer("a", room(1200, 1200), 0, Pose(0.1, 0.1, 0.1))
    fusion.render()
    assert sum(computed) > 1200 * 1200
    computed.clear()
    changed = room(1200, 1200)
    changed.cells[600:632, 600:632] = OCCUPIED
    fusion.set_layer("a", changed, 1, Pose(0.1, 0.1, 0.1), Box(600, 600, 632, 632))
    assert fusion.render().changed.area < 64 * 64
    assert sum(computed) < 320 * 320


def test_maps_that_know_nothing_near_a_change_cost_nothing(monkeypatch):
    """Each map of a large team made a change reach further, and all that far was computed."""
    fusion, computed = GlobalMap("own", USUAL_SIZE), []
    fusion.set_local(unknown(1200, 1200))
    fusion.set_layer("a", room(), 0, Pose())
    for number in range(14):
        fusion.set_layer(f"far_{number}", room(), 0, Pose(20.0, 0.0, 0.0))
    fusion.render()
    weigh = weighing.weighed
    monkeypatch.setattr(
        weighing, "weighed", lambda local, *others: computed.append(local.size) or weigh(local, *others)
    )
    changed = room()
    changed.cells[20:22, 20:22] = OCCUPIED
    fusion.set_layer("a", changed, 1, Pose())
    assert fusion.render() is not None
    assert computed[0] < 200 * 200


def test_a_map_that_never_saw_its_robot_costs_nothing(monkeypatch):
    """Places come several times a second; where nothing stands they change nothing, and nothing is computed."""
    fusion = GlobalMap("own", USUAL_SIZE)
    fusion.set_local(room())
    fusion.set_layer("a", room(), 0, Pose())
    fusion.render()
    monkeypatch.setattr(weighing, "weighed", lambda *_: pytest.fail("computed"))
    fusion.set_places("a", np.array([[1.5, 1.0], [1.6, 1.0]]))
    assert fusion.render() is None


def test_all_maps_as_one():
    result = global_map.merged(unknown(), [(room(), Pose()), (room(), Pose(0.5, 0.0, 0.0))])
    assert value_at(result, 0.025, 1.0) == OCCUPIED
    assert value_at(result, 1.5, 1.0) == FREE
    local = room()
    assert np.array_equal(global_map.merged(local, []).cells, local.cells)


# The benchmark


def test_the_benchmark_measures_what_it_says():
    rows = fusion_benchmark.timing_rows(3, 200, 3, 1, "test")
    assert [row["unit"] for row in rows] == ["ms", "ms", "MB"]
    assert all(row["value"] > 0.0 for row in rows)
    assert all(row["holds"] for row in fusion_benchmark.quality_rows(1, 1, "test"))


def test_the_benchmark_counts_wrong_walls_and_seams():
    team = fusion_benchmark.synthetic_team(np.random.default_rng(1))
    good = fusion_benchmark.merged_map(team, Policy.STRICT)
    cells = good.cells.copy()
    row, column = (int(value) for value in np.argwhere(free_cells(good))[free_cells(good).sum() // 2])
    cells[row - 3 : row + 4, column - 3 : column + 4] = UNKNOWN
    seams = fusion_benchmark.quality_of(team, OccupancyGrid(good.info, cells)).seams
    assert seams >= fusion_benchmark.quality_of(team, good).seams + 20
    moved = OccupancyGrid(window(good.info, Box(20, 20, *(size + 20 for size in good.info.shape))), good.cells)
    assert fusion_benchmark.quality_of(team, moved).wrong_walls > 20.0
