"""Properties of the planner on random maps, and what it says where there is no way."""

import heapq
import math
from typing import List, Optional, Tuple

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from usual_robot import navigation_with

from mr_grid import OccupancyGrid, Pose
from mr_robot import _navigation
from mr_robot.navigation.driven import DrivenGround
from mr_robot.navigation.planner import CostMap, Plan, path, plan, without_robots

OPTIONS = navigation_with()
RADIUS = OPTIONS.largest_robot_radius
SIZE = 60  # cells


@st.composite
def grids(draw: st.DrawFn) -> OccupancyGrid:
    cells = np.zeros((SIZE, SIZE), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    for _ in range(draw(st.integers(0, 6))):
        row, column = draw(st.integers(0, SIZE - 1)), draw(st.integers(0, SIZE - 1))
        height, width = draw(st.integers(1, 30)), draw(st.integers(1, 30))
        cells[row : row + height, column : column + width] = draw(st.sampled_from([100, 100, -1]))
    return OccupancyGrid.of(cells, 0.05, Pose(-1.0, 2.0))


places = st.tuples(st.floats(-0.9, 1.9), st.floats(2.1, 4.9))


def shortest(slowness: np.ndarray, start: Tuple[int, int], goal: Tuple[int, int]) -> Optional[float]:
    """Dijkstra over 8 neighbours, in cells: never shorter than the true way, at most 8.3 % longer on free ground."""
    best = {start: 0.0}
    heap = [(0.0, start)]
    while heap:
        cost, (row, column) = heapq.heappop(heap)
        if (row, column) == goal:
            return cost
        if cost > best[row, column]:
            continue
        for dr in (-1, 0, 1):
            for dc in (-1, 0, 1):
                cell = (row + dr, column + dc)
                if not (0 <= cell[0] < SIZE and 0 <= cell[1] < SIZE) or not math.isfinite(slowness[cell]):
                    continue
                step = cost + math.hypot(dr, dc) * 0.5 * (slowness[row, column] + slowness[cell])
                if step < best.get(cell, math.inf):
                    best[cell] = step
                    heapq.heappush(heap, (step, cell))
    return None


@settings(suppress_health_check=[HealthCheck.filter_too_much])
@given(grids(), places, places)
def test_path_is_free_and_leads_to_the_goal(
    grid: OccupancyGrid, start: Tuple[float, float], goal: Tuple[float, float]
) -> None:
    costs = CostMap(grid, OPTIONS)
    slowness = costs.slowness(np.empty((0, 2)), None)
    assume(np.isfinite(slowness[grid.info.cell_of(*start)]))
    way = plan(costs, np.empty((0, 2)), (*start, 0.0), goal, 0.5)
    if way is None:
        return
    points = path(way, (*start, 0.0))
    for x, y in points:
        row, column = grid.info.cell_of(x, y)
        assert grid.cells[row, column] == 0
        assert costs.wall_distance[row, column] >= OPTIONS.inscribed_radius
    assert math.dist(points[-1], way.goal) < 0.06
    assert math.dist(way.goal, goal) < (0.06 if way.exact else 0.55)


@given(grids(), places, places)
def test_cost_is_near_the_optimum_and_no_way_means_no_way(
    grid: OccupancyGrid, start: Tuple[float, float], goal: Tuple[float, float]
) -> None:
    costs = CostMap(grid, OPTIONS)
    slowness = costs.slowness(np.empty((0, 2)), None)
    first, last = grid.info.cell_of(*start), grid.info.cell_of(*goal)
    slowness[first] = min(slowness[first], 25.0)
    slowness[last] = min(slowness[last], 25.0)
    reference = shortest(slowness, first, last)
    cost = float(_navigation.march(slowness, [(*last, 0.0)], first)[first])
    if reference is None:
        assert math.isinf(cost)
    elif reference > 0.0:
        assert 0.75 * reference - 30.0 <= cost <= 1.35 * reference + 30.0


@given(grids(), grids(), places, places, places)
def test_a_march_beside_a_former_one_is_the_same_as_a_fresh_one(
    before: OccupancyGrid,
    after: OccupancyGrid,
    start: Tuple[float, float],
    later: Tuple[float, float],
    goal: Tuple[float, float],
) -> None:
    slow = [CostMap(grid, OPTIONS).slowness(np.empty((0, 2)), (*start, 0.0)) for grid in (before, after)]
    seeds = [(*before.info.cell_of(*goal), 0.0)]
    former = _navigation.march(slow[0], seeds, before.info.cell_of(*start), 3.0)
    fresh = _navigation.march(slow[1], seeds, after.info.cell_of(*later), 3.0)
    resumed = _navigation.march(slow[1], seeds, after.info.cell_of(*later), 3.0, former=(slow[0], former))
    # Where the former march went farther the costs are kept.
    reached = np.isfinite(fresh)
    assert (resumed[reached] == fresh[reached]).all()
    whole = _navigation.march(slow[1], seeds)
    assert (resumed[np.isfinite(resumed)] == whole[np.isfinite(resumed)]).all()


@given(grids(), st.lists(places, min_size=2, max_size=6), places)
def test_a_plan_beside_a_former_one_is_the_same_as_a_fresh_one(
    grid: OccupancyGrid, robots: List[Tuple[float, float]], goal: Tuple[float, float]
) -> None:
    costs = CostMap(grid, OPTIONS)
    former = None
    for robot in robots:
        fresh = plan(costs, np.empty((0, 2)), (*robot, 0.0), goal, 0.3)
        former = plan(costs, np.empty((0, 2)), (*robot, 0.0), goal, 0.3, former)
        assert (former is None) == (fresh is None)
        if former is not None and fresh is not None:
            reached = np.isfinite(fresh.cost)
            assert (former.cost[reached] == fresh.cost[reached]).all() and former.goal == fresh.goal
            assert path(former, (*robot, 0.0)) == path(fresh, (*robot, 0.0))


@given(
    grids(),
    st.lists(st.tuples(places, st.sampled_from([-1, 0, 100])), max_size=5),
    st.sampled_from([0.03, 0.04, 0.05, 0.06]),
)
def test_costs_beside_former_ones_are_the_same_as_fresh_ones(
    grid: OccupancyGrid, changes: List[Tuple[Tuple, int]], resolution: float
) -> None:
    grid = OccupancyGrid.of(grid.cells, resolution, grid.origin)
    cells = grid.cells.copy()
    for place, value in changes:
        cells[tuple(np.clip(grid.info.cell_of(*place), 0, np.array(cells.shape) - 1))] = value
    changed = OccupancyGrid(grid.info, cells)
    fresh, beside = CostMap(changed, OPTIONS), CostMap(changed, OPTIONS, CostMap(grid, OPTIONS))
    assert (beside.wall_distance == fresh.wall_distance).all()
    nothing = np.empty((0, 2))
    assert (beside.slowness(nothing, None) == fresh.slowness(nothing, None)).all()


@given(grids(), st.lists(places, max_size=5))
def test_slowness_beside_obstacles_is_that_beside_walls(grid: OccupancyGrid, points: List[Tuple[float, float]]) -> None:
    costs = CostMap(grid, OPTIONS)
    cells = grid.cells.copy()
    for point in points:
        cells[grid.info.cell_of(*point)] = 100
    walls = CostMap(OccupancyGrid(grid.info, cells), OPTIONS).slowness(np.empty((0, 2)), None)
    beside = costs.slowness(np.array(points).reshape(-1, 2), None)
    seen = grid.cells >= 0
    assert (beside[seen] == walls[seen]).all()
    distance = cv2.distanceTransform((grid.cells <= 50).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * 0.05
    near = distance < OPTIONS.inflation_radius
    assert np.allclose(costs.wall_distance[near], distance[near]) and (costs.wall_distance[~near] >= 0.599).all()


def test_free_ground_costs_its_length() -> None:
    slowness = np.ones((200, 200), np.float32)
    cost = _navigation.march(slowness, [(100, 100, 0.0)])
    assert abs(cost[100, 180] - 80.0) < 1e-3
    assert abs(cost[160, 180] - 100.0) < 3.0


def test_closed_room_is_no_way_and_goal_in_a_wall_goes_beside_it() -> None:
    cells = np.zeros((SIZE, SIZE), np.int8)
    cells[:, 30] = 100
    grid = OccupancyGrid.of(cells, 0.05)
    costs = CostMap(grid, OPTIONS)
    assert plan(costs, np.empty((0, 2)), Pose(0.7, 1.5, 0.0), (2.5, 1.5), 0.5) is None
    beside = plan(costs, np.empty((0, 2)), Pose(0.7, 1.5, 0.0), (1.5, 1.5), 0.5)
    assert beside is not None and not beside.exact and 1.1 < beside.goal[0] < 1.3


def test_a_way_that_the_robot_came_is_one_however_near_the_walls_are_drawn() -> None:
    """A robot at the end of a corridor as wide as itself found no way out of it: its wall was drawn inside."""
    cells = np.full((60, 60), 100, np.int8)
    cells[10:50, 26:36] = 0
    cells[30, 32:36] = 100
    grid, options = OccupancyGrid.of(cells, 0.05), navigation_with()
    driven = DrivenGround()
    inside, out = (1.45, 0.9), (1.45, 2.2)

    def way() -> Optional[Plan]:
        costs = CostMap(grid, options, driven=driven)
        return plan(costs, np.empty((0, 2)), Pose(*inside, 0.0), out, 0.1, narrow=True)

    assert way() is None
    for y in np.arange(out[1], inside[1], -0.04):
        driven.add(Pose(1.45, y, 0.0), grid.resolution)
    assert way() is not None
    driven.add(Pose(30.0, -30.0, 0.0), grid.resolution)  # beside the map
    assert plan(CostMap(grid, options, driven=driven), np.empty((0, 2)), Pose(*inside, 0.0), out, 0.1) is None


def test_unknown_is_no_ground_unless_allowed() -> None:
    cells = np.zeros((SIZE, SIZE), np.int8)
    cells[:, 25:35] = -1
    grid = OccupancyGrid.of(cells, 0.05)
    start, goal = Pose(0.5, 1.5, 0.0), (2.5, 1.5)
    assert plan(CostMap(grid, OPTIONS), np.empty((0, 2)), start, goal, 0.3) is None
    assert plan(CostMap(grid, navigation_with(allow_unknown=True)), np.empty((0, 2)), start, goal, 0.3) is not None


def two_rooms() -> np.ndarray:
    """6 m x 4 m, a wall without a door at x = 3."""
    cells = np.zeros((80, 120), np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = 100
    cells[:, 60:62] = 100
    return cells


def test_a_robot_beside_a_wall_makes_no_hole_in_it() -> None:
    """Robots 0.3 m from a wall opened a hole of half a metre: ways led through the wall."""
    grid = OccupancyGrid.of(two_rooms(), 0.05)
    for x in (2.7, 2.95, 3.4):
        seen = without_robots(grid, [(x, 2.0)], RADIUS)
        assert (seen.cells == grid.cells).all()
        assert plan(CostMap(seen, OPTIONS), np.empty((0, 2)), Pose(1.5, 2.0, 0.0), (4.5, 2.0), 0.5) is None


def test_what_a_laser_saw_of_a_robot_is_forgotten() -> None:
    cells = two_rooms()
    cells[30:50, 60:62] = 0
    door = cells.copy()
    cells[36:44, 57:66] = 100
    grid = OccupancyGrid.of(cells, 0.05)
    assert plan(CostMap(grid, OPTIONS), np.empty((0, 2)), Pose(1.5, 2.0, 0.0), (4.5, 2.0), 0.5) is None
    assert (without_robots(grid, [(3.2, 2.1)], RADIUS).cells == door).all()
    assert (without_robots(grid, [(4.0, 2.0)], RADIUS).cells == cells).all()
    assert (grid.cells == cells).all(), "the map itself stays as it is"


def test_a_map_without_traces_of_robots_is_not_copied() -> None:
    """Positions come twice a second from each robot; copies and what follows from them took a sixth of navigation."""
    cells = np.zeros((80, 80), np.int8)
    cells[:, 0] = 100
    grid = OccupancyGrid.of(cells, 0.05)
    assert without_robots(grid, [(2.0, 2.0), (0.3, 2.0)], RADIUS) is grid


def test_room_to_get_free_and_to_pass_follows_the_size_of_the_robots() -> None:
    large = navigation_with(footprint_length=0.9, footprint_width=0.7, inflation_radius=0.8, largest_robot_radius=0.6)
    assert OPTIONS.passing_distance == 0.781 and OPTIONS.reach == 1.266
    assert large.passing_distance == 1.37 and large.reach == 1.545
    cells = np.zeros((80, 80), np.int8)
    cells[:, 0] = 100
    grid = OccupancyGrid.of(cells, 0.05)
    for options, reach in ((OPTIONS, 0.45), (large, 0.61)):
        opened = CostMap(grid, options).slowness(np.empty((0, 2)), Pose(0.1, 2.0, 0.0)) == 12.0
        assert np.ptp(np.flatnonzero(opened.any(axis=1))) * 0.05 / 2 == pytest.approx(reach, abs=0.05)


def test_a_robot_that_brakes_slowly_looks_as_much_farther() -> None:
    slow = navigation_with(linear_acceleration=0.25)
    assert slow.horizon == pytest.approx(2.0 + 2.0 + slow.controller_period)
    assert slow.reach == pytest.approx(OPTIONS.reach + 0.5 * (slow.horizon - OPTIONS.horizon), abs=1e-3)
