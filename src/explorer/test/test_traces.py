"""What of a map is taken for another robot: small isolated obstacles only, wherever the robot says it is."""

import math

import numpy as np
from conftest import map_of
from usual_robot import LARGEST

from explorer.ground import Ground
from explorer.travel import TravelGrid
from explorer.ways import Ways


def two_rooms(thickness: int = 2) -> np.ndarray:
    """6 m x 4 m, cells of 0.05 m, a wall without a door from y = 0 to y = 4 at x = 3."""
    cells = np.zeros((80, 120), dtype=np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = 100
    cells[:, 60 : 60 + thickness] = 100
    return cells


def test_a_robot_beside_a_wall_makes_no_hole_in_it() -> None:
    """Robots 0.3 m from a wall opened a hole of half a metre: ways and lines of sight led through the wall."""
    occupancy = map_of(two_rooms(), 0.05)
    for x in (2.7, 2.95, 3.4):
        grid = TravelGrid(occupancy, 0.25, 0.6, ground=Ground.of(occupancy, 0.25, [(x, 2.0)], LARGEST))
        assert math.isinf(grid.field_from(1.5, 2.0).at(4.5, 2.0))
        assert (grid.occupied == occupancy.occupied).all()


def test_what_a_laser_saw_of_a_robot_is_forgotten() -> None:
    cells = two_rooms()
    cells[30:50, 60:62] = 0
    cells[36:44, 57:66] = 100
    occupancy = map_of(cells, 0.05)
    assert math.isinf(TravelGrid(occupancy, 0.25, 0.6).field_from(1.5, 2.0).at(4.5, 2.0))
    assert math.isfinite(
        TravelGrid(occupancy, 0.25, 0.6, ground=Ground.of(occupancy, 0.25, [(3.2, 2.1)], LARGEST))
        .field_from(1.5, 2.0)
        .at(4.5, 2.0)
    )
    assert math.isinf(
        TravelGrid(occupancy, 0.25, 0.6, ground=Ground.of(occupancy, 0.25, [(4.0, 2.0)], LARGEST))
        .field_from(1.5, 2.0)
        .at(4.5, 2.0)
    )


def test_how_large_a_trace_may_be_follows_the_largest_robot_of_the_team() -> None:
    cells = np.zeros((80, 80), dtype=np.int8)
    cells[30:50, 30:50] = 100  # 1 m across
    occupancy, places = map_of(cells, 0.05), [(2.0, 2.3)]
    ground = TravelGrid(occupancy, 0.25, 0.6).ground
    assert Ways(occupancy, 0.25, places, LARGEST).grid.ground.count == ground.count
    assert Ways(occupancy, 0.25, places, 0.4).grid.ground.count == cells.size


def test_a_smaller_robot_is_comfortable_nearer_to_walls() -> None:
    occupancy = map_of(two_rooms(), 0.05)
    along = {
        radius: Ways(occupancy, radius, [], LARGEST).grid.field_from(0.5, 2.0).at(2.5, 2.0) for radius in (0.15, 0.25)
    }
    assert along[0.15] < along[0.25]
