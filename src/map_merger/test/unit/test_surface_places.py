"""A robot that another one saw as a wall must not speak against the true transform."""

import math

import numpy as np

from map_merger.evidence import compare
from map_merger.surface import landmarks_of, without_places
from mr_grid import GridInfo, OccupancyGrid, Pose

RESOLUTION = 0.05


def room(robot=None):
    """A room of 4 m x 3 m; `robot`: middle (x, y) of the trail that a moving robot left, 1.2 m long."""
    cells = np.zeros((60, 80), np.int8)
    cells[[0, -1], :] = 100
    cells[:, [0, -1]] = 100
    if robot is not None:
        column, row = (int(value / RESOLUTION) for value in robot)
        cells[row - 5 : row + 5, column - 12 : column + 12] = 100
        cells[row - 4 : row + 4, column - 11 : column + 11] = -1
    return landmarks_of(OccupancyGrid(GridInfo(80, 60, RESOLUTION), cells))


def test_seen_robot_is_no_contradiction_where_it_has_been():
    here, seen_from_there = room(), room(robot=(2.0, 1.5))
    assert compare(here, seen_from_there, Pose()).conflict > 0.05
    track = np.array([[0.5, 1.5], [1.5, 1.5], [2.0, 1.5], [2.5, 1.5]])
    assert compare(without_places(here, track, 0.35), seen_from_there, Pose()).conflict == 0.0


def test_a_wall_elsewhere_still_contradicts():
    here, other = room(), room(robot=(2.0, 1.5))
    track = np.array([[0.5, 1.5], [100.0, -100.0]])
    assert compare(without_places(here, track, 0.35), other, Pose()).conflict > 0.05


def test_no_places_change_nothing():
    here = room()
    assert without_places(here, np.zeros((0, 2)), 0.35) is here
    assert math.isclose(without_places(here, np.array([[50.0, 50.0]]), 0.35).clear.sum(), here.clear.sum())
