"""Maps in tiles: what is kept, what has changed, bounds."""

import numpy as np
import pytest

from mr_grid import OccupancyGrid, Pose
from mr_page import tiles
from mr_page.state import PageState
from mr_page.tiles import BLANK, FREE, OCCUPIED, TILE, UNKNOWN, unpacked

RESOLUTION = 0.05


def new_map():
    return PageState().map("robot_0", "local")


def grid(rows, columns, value=0, corner=(0, 0), yaw=0.0):
    """Cells of one value; the corner in cells."""
    origin = Pose(corner[1] * RESOLUTION, corner[0] * RESOLUTION, yaw)
    return OccupancyGrid.of(np.full((rows, columns), value, dtype=np.int8), RESOLUTION, origin)


def classes(tiled, top, left, rows, columns):
    """Of a box of cells of the lattice."""
    found = np.zeros((rows, columns), dtype=int)
    for row in range(rows):
        for column in range(columns):
            r, c = top + row, left + column
            found[row, column] = unpacked(tiled.cells_at((r // TILE, c // TILE)))[r % TILE, c % TILE]
    return found


def test_cells_are_told_as_they_are():
    tiled = new_map()
    cells = np.array([[-1, 0, 49], [50, 100, -1]], dtype=np.int8)
    tiled.take(OccupancyGrid.of(cells, RESOLUTION))
    assert classes(tiled, 0, 0, 2, 3).tolist() == [[UNKNOWN, FREE, FREE], [OCCUPIED, OCCUPIED, UNKNOWN]]


def test_random_maps_come_through_with_any_corner():
    rng = np.random.default_rng(3)
    for corner in ((0, 0), (5, -7), (-130, 64)):
        tiled = new_map()
        tiled.take(grid(4, 4))
        cells = rng.integers(-1, 101, (150, 90)).astype(np.int8)
        origin = Pose(corner[1] * RESOLUTION, corner[0] * RESOLUTION)
        tiled.take(OccupancyGrid.of(cells, RESOLUTION, origin))
        assert (classes(tiled, *corner, 150, 90) == tiles.classes_of(cells)).all()


def test_only_changed_tiles_are_new():
    tiled = new_map()
    tiled.take(grid(4 * TILE, 4 * TILE))
    _, version, rest = tiled.changed_since(0, 100)
    assert len(tiled) == 16 and rest == 0
    again = grid(4 * TILE, 4 * TILE).cells.copy()
    again[70, 10] = 100
    tiled.take(OccupancyGrid.of(again, RESOLUTION))
    assert [place for place, _ in tiled.changed_since(version, 100).tiles] == [(1, 0)]


def test_growth_to_the_other_side_keeps_what_is_there():
    tiled = new_map()
    tiled.take(grid(TILE, TILE))
    version = tiled.changed_since(0, 100).version
    lattice = tiled.lattice_version
    tiled.take(grid(2 * TILE, 2 * TILE, corner=(-TILE, -TILE)))
    assert tiled.lattice_version == lattice
    assert {place for place, _ in tiled.changed_since(version, 100).tiles} == {(-1, -1), (-1, 0), (0, -1)}


@pytest.mark.parametrize(
    "other", [grid(9, 9, yaw=0.1), grid(9, 9, corner=(0.5, 0)), OccupancyGrid.of(np.zeros((9, 9), dtype=np.int8), 0.1)]
)
def test_another_lattice_begins_anew(other):
    tiled = new_map()
    tiled.take(grid(3 * TILE, TILE))
    before = tiled.lattice_version
    tiled.take(other)
    assert tiled.lattice_version > before and len(tiled) == 1 and tiled.lattice.corner == other.origin


def test_what_is_gone_from_the_map_is_blank():
    tiled = new_map()
    tiled.take(grid(TILE, 2 * TILE))
    tiled.take(grid(TILE, TILE))
    assert tiled.cells_at((0, 1)) == BLANK


def test_parts_of_a_map():
    tiled = new_map()
    tiled.take(grid(100, 100, value=-1, corner=(-10, -10)))
    version = tiled.changed_since(0, 100).version
    tiled.patch(60, 60, np.full((20, 10), 100, dtype=np.int8))  # the lattice begins at this map's corner
    assert {place for place, _ in tiled.changed_since(version, 100).tiles} == {(0, 1), (1, 1), (0, 0), (1, 0)}
    assert (classes(tiled, 60, 60, 20, 10) == OCCUPIED).all()
    assert classes(tiled, 59, 60, 1, 10).sum() == 0


@pytest.mark.parametrize("place", [(-1, 0), (0, 99), (99, 0)])
def test_parts_outside_are_refused(place):
    tiled = new_map()
    tiled.take(grid(100, 100))
    with pytest.raises(ValueError, match="is not in a map"):
        tiled.patch(*place, np.zeros((2, 2), dtype=np.int8))


def test_a_part_before_the_map_is_refused():
    with pytest.raises(ValueError, match="before the map"):
        new_map().patch(0, 0, np.zeros((2, 2), dtype=np.int8))


def test_a_map_has_a_bound(monkeypatch):
    monkeypatch.setattr(tiles, "MAX_TILES", 6)
    tiled = new_map()
    tiled.take(grid(4 * TILE, 4 * TILE))
    assert len(tiled) == 6 and tiled.clipped


def test_the_oldest_changes_are_told_first_and_none_is_lost():
    tiled = new_map()
    tiled.take(grid(4 * TILE, 4 * TILE))
    seen, version = [], 0
    while True:
        found, version, rest = tiled.changed_since(version, 5)
        seen += [place for place, _ in found]
        if not rest:
            break
    assert len(seen) == len(set(seen)) == 16
