"""What is taken for a robot follows the size of the team's robots."""

import numpy as np
import pytest

from map_merger.global_map import GlobalMap, Policy
from map_merger.meetings.map_objects import objects_in_map
from map_merger.options import options_of
from map_merger.robot_size import USUAL_SIZE
from map_merger.surface import landmarks_of
from mr_grid import GridInfo, OccupancyGrid, Pose

LARGE = options_of({"body_radius": 0.5, "largest_robot_radius": 0.6}, "host").robot_size
HALL = GridInfo(200, 200, 0.05)


def hall(block=0):
    """10 m x 10 m of floor with an obstacle in the middle, `block` cells across."""
    cells = np.zeros((200, 200), np.int8)
    low = 100 - block // 2
    cells[low : low + block, low : low + block] = 100
    return OccupancyGrid(HALL, cells)


def test_lengths_for_robots_like_a_pioneer():
    size = options_of({}, "host").robot_size
    lengths = (size.inner, size.visible, size.touching, size.clearance, size.near)
    assert lengths == (0.1, 0.3, 0.35, 0.4, 0.45)
    assert (size.widest, size.left, size.largest, size.mover) == (0.65, 0.7, 0.8, 0.9)


def test_objects_that_may_be_robots():
    found = [objects_in_map(hall(18), Pose(2.0, 2.0), 6.0, size.widest) for size in (USUAL_SIZE, LARGE)]
    assert [len(centres) for centres in found] == [0, 1]


@pytest.mark.parametrize(("size", "left"), [(USUAL_SIZE, 0.6), (LARGE, 0.0)])
def test_a_robot_that_was_there_is_no_wall(size, left):
    """It drove by where its own map shows floor."""
    fusion = GlobalMap("own", size, Policy.STRICT)
    fusion.set_local(hall(22))
    fusion.set_layer("other", hall(), 1, Pose())
    fusion.set_places("other", np.array([(5.0, 5.0)]))
    update = fusion.render()
    assert update is not None
    share = (update.grid.cells > 50).sum() / 22**2
    assert left <= share <= left + 0.2


def test_landmarks_are_larger_than_robots():
    cells = np.zeros((200, 200), np.int8)
    cells[100:102, 89:111] = 100
    solid = [landmarks_of(OccupancyGrid(HALL, cells), size.mover).surface.solid.any() for size in (USUAL_SIZE, LARGE)]
    assert solid == [True, False]
