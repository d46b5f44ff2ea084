"""What of a map is taken for a robot: small isolated obstacles only, wherever the robot says it is."""

import math
from typing import List, Tuple

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mr_grid import OccupancyGrid, Pose
from mr_grid.robot_traces import cells_without_robots, extent_of, reach_of, robot_traces

RADIUS = 0.29


@given(
    st.lists(st.tuples(st.integers(0, 59), st.integers(0, 59), st.integers(1, 12), st.integers(1, 12)), max_size=12),
    st.lists(st.tuples(st.floats(-1.5, 4.5), st.floats(-1.5, 4.5)), max_size=3),
)
def test_the_rule_holds_wherever_a_robot_is(
    boxes: List[Tuple[int, int, int, int]], places: List[Tuple[float, float]]
) -> None:
    cells = np.zeros((60, 50), np.int8)
    for row, column, height, width in boxes:
        cells[row : row + height, column : column + width] = 100
    grid = OccupancyGrid.of(cells, 0.05, Pose(0.3, -0.2))
    count, labels = cv2.connectedComponents((cells > 0).astype(np.uint8), connectivity=8)
    expected = cells.copy()
    for label in range(1, count):
        found = np.argwhere(labels == label)
        middle = grid.info.centre_of(*found.mean(axis=0))
        small = (np.ptp(found, axis=0).max() + 1) * 0.05 <= extent_of(RADIUS) + 1e-9
        if small and any(math.dist(middle, place) <= reach_of(RADIUS) for place in places):
            expected[labels == label] = 0
    assert (cells_without_robots(grid, places, RADIUS, 100) == expected).all()


def test_how_large_a_trace_may_be_follows_the_radius() -> None:
    cells = np.zeros((80, 80), np.int8)
    cells[30:50, 30:50] = 100  # 1 m across
    grid = OccupancyGrid.of(cells, 0.05)
    assert not len(robot_traces(grid, [(2.0, 2.3)], RADIUS, 51))
    assert len(robot_traces(grid, [(2.0, 2.3)], 0.4, 51)) == 400


def test_a_map_without_traces_is_not_copied() -> None:
    cells = np.zeros((80, 80), np.int8)
    cells[:, 0] = 100
    grid = OccupancyGrid.of(cells, 0.05)
    assert cells_without_robots(grid, [(2.0, 2.0), (0.3, 2.0)], RADIUS, 51) is cells


def test_what_is_no_obstacle_is_no_trace() -> None:
    cells = np.zeros((40, 40), np.int8)
    cells[18:22, 18:22] = 50
    grid = OccupancyGrid.of(cells, 0.05)
    assert not len(robot_traces(grid, [(1.0, 1.0)], RADIUS, 51))
    assert len(robot_traces(grid, [(1.0, 1.0)], RADIUS, 50)) == 16


@pytest.mark.parametrize("place", [(1e18, 0.0), (0.0, -1e300), (math.inf, math.nan)])
def test_a_place_far_outside_has_no_traces(place: Tuple[float, float]) -> None:
    grid = OccupancyGrid.of(np.full((4, 4), 100, np.int8), 0.05)
    assert not len(robot_traces(grid, [place], RADIUS, 51))
