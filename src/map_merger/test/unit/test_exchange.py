"""The exchange of map changes: whatever is lost or reordered, the copies become equal again."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from map_merger.exchange import MapSender, PeerMap, bounds
from map_merger.grid import UNKNOWN, Box, Grid, GridError, GridInfo, known_box, offset_between, window
from map_merger.messages import NO_BOOT, Anchor, Tile
from map_merger.transform import Transform

BOOT = (1, 0)
FIRST = GridInfo(12, 10, 0.05, Transform(-1.0, 2.0, 0.4))


def grid_at(top, left, cells):
    """A map on the lattice of FIRST with its corner at the offset."""
    cells = np.array(cells, np.int8)
    return Grid(window(FIRST, Box(top, left, top + cells.shape[0], left + cells.shape[1])), cells)


def sender_with(grid, tile_size=32):
    sender = MapSender("robot_0", tile_size, BOOT)
    sender.set_map(grid)
    return sender


def same_cells(peer_grid, grid):
    """All known cells, and no others."""
    if peer_grid is None:
        return bool((grid.cells == UNKNOWN).all())
    box = known_box(grid)
    return (
        offset_between(peer_grid.info, grid.info) == (box.top, box.left)
        and peer_grid.cells.tolist() == grid.cells[box.slices()].tolist()
    )


def repair(sender, peer):
    """Asks until nothing is missing; the number of rounds is bounded."""
    for _ in range(5):
        wanted = peer.wanted()
        if wanted is None:
            return
        peer.set_anchor(sender.anchor(), 0.0)
        for tile in sender.again(wanted) if wanted else sender.everything():
            peer.add(tile, 0.0)
    pytest.fail(f"still missing {peer.wanted()}")


def test_numbers_start_at_zero_and_count_the_tiles():
    sender = sender_with(grid_at(0, 0, np.zeros((10, 12))), tile_size=5)
    tiles = sender.changes()
    assert [tile.numbers for tile in tiles] == [(n,) for n in range(6)]
    assert sender.changes() == []
    assert sender.anchor() == Anchor("robot_0", GridInfo(0, 0, 0.05, FIRST.origin), BOOT, 6)


def test_only_tiles_with_changes_are_sent():
    cells = np.zeros((10, 12))
    sender = sender_with(grid_at(0, 0, cells), tile_size=4)
    sender.changes()
    cells[0, 0], cells[9, 11] = 100, 100
    sender.set_map(grid_at(0, 0, cells))
    tiles = sender.changes()
    assert [(tile.row, tile.column) for tile in tiles] == [(0, 0), (9, 11)]


def test_tiles_are_halved_however_many_that_makes():
    sender = sender_with(grid_at(0, 0, np.zeros((1000, 1000))), tile_size=2048)
    (tile,) = sender.changes()
    assert tile.cells.shape == (1000, 1000)
    for edge in (500, 250, 125, 62, 31):
        assert sender.halve(tile)
        tile = sender.again([0])[0]
        assert tile.cells.shape == (edge, edge)
    assert len(sender.again([0])) > bounds.MOST_TILES
    assert not sender.halve(tile)


def test_growth_to_the_south_west_gives_negative_offsets_and_keeps_the_anchor():
    sender = sender_with(grid_at(0, 0, np.zeros((10, 12))))
    sender.changes()
    sender.set_map(grid_at(-7, -3, np.zeros((20, 20))))
    (tile,) = sender.changes()
    assert (tile.row, tile.column) == (-7, -3)
    assert sender.anchor().info.origin == FIRST.origin
    peer = PeerMap("robot_0")
    peer.set_anchor(sender.anchor(), 0.0)
    for part in sender.everything():
        peer.add(part, 0.0)
    assert offset_between(peer.grid().info, FIRST) == (-7, -3)


def test_another_resolution_is_refused():
    sender = sender_with(grid_at(0, 0, np.zeros((3, 3))))
    with pytest.raises(GridError, match="resolution"):
        sender.set_map(Grid(GridInfo(3, 3, 0.1), np.zeros((3, 3), np.int8)))


def test_a_full_answer_has_the_margin_and_each_number_comes_when_its_region_is_complete():
    sender = sender_with(grid_at(0, 0, np.zeros((10, 12))), tile_size=11)
    sender.changes()
    tiles = sender.everything()
    assert (tiles[0].row, tiles[0].column) == (-bounds.FULL_MAP_MARGIN,) * 2
    assert [tile.numbers for tile in tiles] == [(), (), (), (0, 1)]
    assert [tile.numbers for tile in sender.again([0])] == [(0,)]


@pytest.mark.parametrize("numbers", [[5], [-1], [-7, 10**9], []])
def test_unknown_numbers_are_harmless(numbers):
    sender = sender_with(grid_at(0, 0, np.zeros((3, 3))))
    sender.changes()
    assert sender.again(numbers) == []
    assert MapSender("robot_0", 32, BOOT).everything() == []


def test_forgotten_updates_are_answered_with_everything(monkeypatch):
    monkeypatch.setattr(bounds, "MOST_BOXES", 2)
    cells = np.zeros((10, 12))
    sender = sender_with(grid_at(0, 0, cells))
    for value in range(4):
        cells[0, 0] = value + 1
        sender.set_map(grid_at(0, 0, cells))
        sender.changes()
    assert sender.again([0])[-1].numbers == (0, 1, 2, 3)
    assert sender.again([3])[-1].box == Box(0, 0, 1, 1)


def test_the_number_of_tiles_is_bounded(monkeypatch):
    monkeypatch.setattr(bounds, "MOST_TILES", 6)
    assert len(sender_with(grid_at(0, 0, np.zeros((10, 12))), tile_size=1).changes()) <= 6


def test_not_splitted_is_one_tile():
    assert len(sender_with(grid_at(0, 0, np.zeros((100, 120))), tile_size=None).changes()) == 1


def test_a_tile_waits_for_its_anchor():
    sender = sender_with(grid_at(0, 0, np.zeros((10, 12))))
    peer = PeerMap("robot_0")
    assert not peer.add(sender.changes()[0], 0.0)
    assert peer.wanted() == () and peer.grid() is None
    assert not peer.set_anchor(sender.anchor(), 0.0)
    assert peer.wanted() is None
    assert (peer.grid().cells == 0).all()


def test_waiting_tiles_are_bounded(monkeypatch):
    monkeypatch.setattr(bounds, "MOST_WAITING_CELLS", 100)
    peer = PeerMap("robot_0")
    for number in range(5):
        peer.add(Tile("robot_0", (number,), 0, number * 6, np.zeros((6, 6), np.int8), 0.05, BOOT), 0.0)
    peer.set_anchor(Anchor("robot_0", GridInfo(0, 0, 0.05), BOOT), 0.0)
    assert peer.grid().info.width == 12
    assert peer.wanted() == (0, 1, 2)


@pytest.mark.parametrize("size", [0, 1])
def test_waiting_tiles_are_bounded_in_number(size):
    """Tiles without cells grew the list for ever; a tile of one cell made each next one slower."""
    peer = PeerMap("robot_0")
    for number in range(2 * bounds.MOST_WAITING_TILES):
        peer.add(Tile("robot_0", (number,), 0, number, np.zeros((size, size), np.int8), 0.05, BOOT), 0.0)
    assert len(peer._waiting) == bounds.MOST_WAITING_TILES
    assert peer.stored == size * bounds.MOST_WAITING_TILES


def test_a_waiting_tile_that_cannot_belong_to_the_map_is_dropped_and_the_others_are_drawn():
    peer = PeerMap("robot_0")
    for number, (column, resolution) in enumerate([(0, 0.1), (0, 0.05), (10**9, 0.05)]):
        peer.add(Tile("robot_0", (number,), 10**9, column, np.zeros((2, 2), np.int8), resolution, BOOT), 0.0)
    assert not peer.set_anchor(Anchor("robot_0", GridInfo(0, 0, 0.05), BOOT, 3), 0.0)
    assert peer.grid().info.shape == (2, 2)
    assert peer.wanted() == (0, 2)


def test_one_far_cell_does_not_cost_more_memory_than_one_map_may_have():
    """A tile of one cell at (7900, 7900) took 300 MB."""
    peer = PeerMap("robot_0")
    peer.set_anchor(Anchor("robot_0", GridInfo(0, 0, 0.05), BOOT), 0.0)
    peer.add(Tile("robot_0", (0,), 0, 0, np.zeros((1, 1), np.int8), 0.05, BOOT), 0.0)
    with pytest.raises(GridError, match="row 7900"):
        peer.add(Tile("robot_0", (1,), 7900, 7900, np.zeros((1, 1), np.int8), 0.05, BOOT), 0.0)
    assert peer.stored == 64 * 64


def test_waiting_tiles_count_for_the_room_of_a_map():
    peer = PeerMap("robot_0")
    for number in range(5):
        peer.add(Tile("robot_0", (number,), 0, number * 10, np.zeros((10, 10), np.int8), 0.05, BOOT), 0.0, 300)
    assert peer.stored == 300


def test_a_restarted_robot_replaces_its_map_even_with_the_same_corner():
    peer = PeerMap("robot_0")
    old = sender_with(grid_at(0, 0, np.zeros((10, 12))))
    peer.set_anchor(old.anchor(), 0.0)
    for tile in old.changes():
        peer.add(tile, 0.0)
    new = MapSender("robot_0", 32, (2, 0))
    new.set_map(grid_at(0, 0, np.full((2, 2), 100)))
    late, early = old.last(), new.changes()
    peer.add(early[0], 0.0)
    assert (peer.grid().cells == 0).all(), "a tile of a run without anchor must not be drawn"
    assert peer.set_anchor(new.anchor(), 0.0)
    assert peer.grid().cells.tolist() == [[100, 100], [100, 100]]
    peer.add(late[0], 0.0)
    assert peer.grid().cells.tolist() == [[100, 100], [100, 100]], "late tiles of the former run are not drawn"


def test_a_repeated_anchor_shows_that_the_last_update_was_lost():
    sender = sender_with(grid_at(0, 0, np.zeros((10, 12))))
    peer = PeerMap("robot_0")
    peer.set_anchor(sender.anchor(), 0.0)
    sender.changes()
    assert peer.wanted() is None
    assert not peer.set_anchor(sender.anchor(), 0.0)
    assert peer.wanted() == (0,)


def test_many_gaps_become_a_request_for_everything():
    peer = PeerMap("robot_0")
    peer.set_anchor(Anchor("robot_0", GridInfo(0, 0, 0.05), BOOT, bounds.MOST_REQUESTED + 1), 0.0)
    assert peer.wanted() == ()


def test_foreign_resolution_and_senders_without_boot():
    peer = PeerMap("robot_0")
    peer.set_anchor(Anchor("robot_0", GridInfo(0, 0, 0.05), BOOT), 0.0)
    with pytest.raises(GridError, match=r"0\.1 m"):
        peer.add(Tile("robot_0", (0,), 0, 0, np.zeros((2, 2), np.int8), 0.1, BOOT), 0.0)
    assert peer.add(Tile("robot_0", (0,), 0, 0, np.zeros((2, 2), np.int8), 0.05, NO_BOOT), 0.0)


@given(st.data())
def test_copies_become_equal_whatever_is_lost_or_reordered(data):
    """Loss, duplication and reordering of tiles on a map that grows in all directions; then repair."""
    random = np.random.default_rng(data.draw(st.integers(0, 2**32 - 1)))
    tile_size = data.draw(st.sampled_from([3, 8, 32, None]))
    sender = MapSender("robot_0", tile_size, BOOT)
    peer = PeerMap("robot_0")
    top, left, cells = 0, 0, random.integers(-1, 101, (6, 7)).astype(np.int8)
    in_flight = []
    for _ in range(data.draw(st.integers(1, 5))):
        sender.set_map(grid_at(top, left, cells))
        in_flight.extend(sender.changes())
        random.shuffle(in_flight)
        for tile in in_flight[::2]:
            if random.random() < 0.7:
                peer.add(tile, 0.0)
                peer.add(tile, 0.0)
        in_flight = in_flight[1::2]
        if random.random() < 0.5:
            peer.set_anchor(sender.anchor(), 0.0)
        pad = random.integers(0, 4, (2, 2))
        top, left = top - pad[0, 0], left - pad[1, 0]
        cells = np.pad(cells, pad, constant_values=UNKNOWN)
        cells[random.random(cells.shape) < 0.3] = random.integers(-1, 101)
        cells[random.random(cells.shape) < 0.2] = UNKNOWN
    sender.set_map(grid_at(top, left, cells))
    sender.changes()
    peer.set_anchor(sender.anchor(), 0.0)
    repair(sender, peer)
    assert same_cells(peer.grid(), grid_at(top, left, cells))


@given(st.integers(0, 2**32 - 1))
def test_reordered_tiles_never_bring_back_old_cells(seed):
    """All tiles arrive, in any order, mixed with answers: the copy is equal without any repair."""
    random = np.random.default_rng(seed)
    sender, peer = MapSender("robot_0", 4, BOOT), PeerMap("robot_0")
    tiles = []
    for _ in range(4):
        cells = random.integers(-1, 101, (6, 7)).astype(np.int8)
        sender.set_map(grid_at(0, 0, cells))
        tiles.extend(sender.changes() + sender.again([0]))
    peer.set_anchor(sender.anchor(), 0.0)
    random.shuffle(tiles)
    for tile in tiles:
        peer.add(tile, 0.0)
    assert peer.wanted() is None
    assert same_cells(peer.grid(), grid_at(0, 0, cells))
