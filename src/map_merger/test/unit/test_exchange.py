"""The exchange of map changes: whatever is lost or reordered, the copies become equal again."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from map_merger.exchange import MapSender, PeerMap, bounds
from map_merger.grid import Box, known_box, offset_between, window
from map_merger.messages import NO_BOOT, Anchor, Tile
from mr_grid import UNKNOWN, GridError, GridInfo, OccupancyGrid, Pose

BOOT = (1, 0)
FIRST = GridInfo(12, 10, 0.05, Pose(-1.0, 2.0, 0.4))


def grid_at(top, left, cells):
    """A map on the lattice of FIRST with its corner at the offset."""
    cells = np.array(cells, np.int8)
    return OccupancyGrid(window(FIRST, Box(top, left, top + cells.shape[0], left + cells.shape[1])), cells)


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
        sender.set_map(OccupancyGrid(GridInfo(3, 3, 0.1), np.zeros((3, 3), np.int8)))


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


# Runs


def told(peer, sender, tiles, now=0.0):
    peer.set_anchor(sender.anchor(), now)
    for tile in tiles:
        peer.add(tile, now)


def runs(*boots, size=4):
    """A sender for each run, each with a map of its own value, and its tiles."""
    senders = [MapSender("robot_0", 32, boot) for boot in boots]
    for value, sender in enumerate(senders):
        sender.set_map(grid_at(0, 0, np.full((size, size), value)))
    return [(sender, sender.changes()) for sender in senders]


def values(peer):
    return set(peer.grid().cells.ravel().tolist())


def test_a_late_tile_of_a_former_run_is_ignored():
    """It waited for its anchor, so that everything was asked for, for ever (210 requests in 10 minutes)."""
    (old, old_tiles), (new, new_tiles) = runs((1, 0), (2, 0))
    peer = PeerMap("robot_0")
    told(peer, old, old_tiles)
    told(peer, new, new_tiles)
    assert not peer.add(old_tiles[0], 1.0)
    assert peer.wanted() is None and values(peer) == {1} and peer.stored == 64 * 64


def test_a_tile_of_an_unknown_run_waits_only_so_long():
    (present, tiles), (_, others) = runs((1, 0), (2, 0))
    peer = PeerMap("robot_0")
    told(peer, present, tiles)
    peer.add(others[0], 5.0)
    peer.expire(5.0 + bounds.LONGEST_WAIT_S - 0.1)
    assert peer.wanted() == ()
    peer.expire(5.0 + bounds.LONGEST_WAIT_S)
    assert peer.wanted() is None and peer.stored == 64 * 64
    peer.add(others[0], 5.0)
    peer.expire(1.0)
    assert peer.wanted() is None, "the clock jumped back"


def test_an_anchor_of_the_present_run_ends_the_wait_for_another_one():
    (present, tiles), (_, others) = runs((1, 0), (2, 0))
    peer = PeerMap("robot_0")
    told(peer, present, tiles)
    peer.add(others[0], 5.0)
    assert peer.wanted() == ()
    peer.set_anchor(present.anchor(), 5.1)
    assert peer.wanted() is None and peer.stored == 64 * 64


def test_the_anchor_of_a_run_that_waited_too_long_is_believed_all_the_same():
    (present, tiles), (new, others) = runs((1, 0), (2, 0))
    peer = PeerMap("robot_0")
    told(peer, present, tiles)
    peer.add(others[0], 5.0)
    peer.expire(60.0)
    assert peer.set_anchor(new.anchor(), 61.0) and peer.wanted() == (0,)


@pytest.mark.parametrize(("first", "second"), [((1, 0), (2, 0)), ((2, 0), (1, 0))])
def test_a_late_anchor_of_a_former_run_does_not_throw_the_new_map_away(first, second):
    """Whichever start time is the higher one: a robot's clock may be set back."""
    (old, old_tiles), (new, new_tiles) = runs(first, second)
    peer = PeerMap("robot_0")
    told(peer, old, old_tiles)
    told(peer, new, new_tiles)
    version, run = peer.version, peer.run
    for now in (1.0, 2.0, 500.0):
        assert not peer.set_anchor(old.anchor(), now)
        assert not peer.set_anchor(new.anchor(), now)
    assert (peer.version, peer.run) == (version, run), "an anchor of the present run is no news"
    assert values(peer) == {1}


def test_a_former_run_that_alone_goes_on_is_believed_again():
    """A late anchor that was taken for a restart would lock the living run out."""
    (alive, tiles), (dead, _) = runs((2, 0), (1, 0))
    peer = PeerMap("robot_0")
    told(peer, alive, tiles)
    assert peer.set_anchor(dead.anchor(), 1.0)
    assert [peer.set_anchor(alive.anchor(), now) for now in (2.0, 7.0, 11.0, 12.0)] == [False, False, False, True]
    told(peer, alive, alive.everything(), 12.0)
    assert values(peer) == {0}


def test_former_runs_are_bounded():
    peer = PeerMap("robot_0")
    for number in range(1, 3 * bounds.MOST_FORMER_RUNS):
        peer.set_anchor(Anchor("robot_0", GridInfo(0, 0, 0.05), (number, 0)), 0.0)
    assert len(peer._former) == bounds.MOST_FORMER_RUNS


def test_what_changed_is_told_once_and_only_of_the_present_run():
    (old, old_tiles), (new, new_tiles) = runs((1, 0), (2, 0))
    peer = PeerMap("robot_0")
    assert peer.take_changed() is None and peer.lattice is None and (peer.cells(Box(0, 0, 2, 2)) == UNKNOWN).all()
    told(peer, old, old_tiles)
    assert peer.take_changed() == Box(0, 0, 4, 4)
    assert peer.take_changed() is None
    peer.add(old_tiles[0], 0.0)
    assert peer.take_changed() is None
    run = peer.run
    peer.set_anchor(new.anchor(), 0.0)
    assert peer.take_changed() is None and peer.run != run
    peer.add(new_tiles[0], 0.0)
    assert peer.take_changed() == Box(0, 0, 4, 4)
    assert (peer.cells(Box(0, 0, 4, 4)) == 1).all() and peer.lattice == new.anchor().info


# Cells that become unknown again


def test_cells_that_become_unknown_again_are_told():
    """They stayed in the maps of the others for ever."""
    cells = np.full((10, 12), 100)
    sender, peer = sender_with(grid_at(0, 0, cells)), PeerMap("robot_0")
    told(peer, sender, sender.changes())
    cells[3:5, 6:9] = UNKNOWN
    sender.set_map(grid_at(0, 0, cells))
    (tile,) = sender.changes()
    assert tile.box == Box(3, 6, 5, 9) and tile.whole
    assert peer.add(tile, 0.0) and peer.take_changed() == Box(0, 0, 10, 12)
    assert same_cells(peer.grid(), grid_at(0, 0, cells))


def test_cells_that_the_local_map_no_longer_covers_are_unknown_again():
    sender, peer = sender_with(grid_at(0, 0, np.zeros((10, 12)))), PeerMap("robot_0")
    told(peer, sender, sender.changes())
    moved = grid_at(5, 5, np.zeros((10, 12)))
    sender.set_map(moved)
    told(peer, sender, sender.changes())
    assert same_cells(peer.grid(), moved)


def test_everything_takes_back_cells_beyond_what_is_known_now():
    cells = np.zeros((30, 30))
    sender, peer = sender_with(grid_at(0, 0, cells), 8), PeerMap("robot_0")
    told(peer, sender, sender.changes())
    cells[:, 10:] = UNKNOWN
    sender.set_map(grid_at(0, 0, cells))
    sender.changes()
    told(peer, sender, sender.everything())
    assert peer.wanted() is None
    assert same_cells(peer.grid(), grid_at(0, 0, cells))


def test_a_late_answer_with_its_margin_does_not_erase_what_a_newer_tile_wrote():
    sender, peer = sender_with(grid_at(0, 0, np.zeros((4, 4)))), PeerMap("robot_0")
    told(peer, sender, sender.changes())
    late = sender.everything()
    larger = grid_at(-3, -3, np.zeros((9, 9)))
    sender.set_map(larger)
    told(peer, sender, sender.changes() + late)
    assert same_cells(peer.grid(), larger)


def test_unknown_cells_of_the_original_say_nothing():
    """Its tiles are the bounding box of what changed, and others never took -1 as a value."""
    peer = PeerMap("robot_0")
    peer.set_anchor(Anchor("robot_0", GridInfo(0, 0, 0.05), NO_BOOT), 0.0)
    peer.add(Tile("robot_0", (0,), 0, 0, np.array([[0, 100]], np.int8), 0.05), 0.0)
    assert not peer.add(Tile("robot_0", (1,), 0, 0, np.full((1, 2), UNKNOWN, np.int8), 0.05, NO_BOOT, 2), 0.0)
    assert peer.grid().cells.tolist() == [[0, 100]]


def test_tiles_of_changes_hold_what_changed_only():
    cells = np.zeros((10, 12))
    sender = sender_with(grid_at(0, 0, cells))
    sender.changes()
    cells[2, 2], cells[4, 5] = 100, 100
    sender.set_map(grid_at(0, 0, cells))
    (tile,) = sender.changes()
    assert tile.box == Box(2, 2, 5, 6) and not tile.whole
    assert (tile.cells != UNKNOWN).sum() == 2
    assert sender.again([1])[0].whole and (sender.again([1])[0].cells != UNKNOWN).all()


# Senders without anchor


def corner(grid):
    return grid.info.origin.x, grid.info.origin.y


def test_a_sender_without_anchor_is_drawn_at_the_corner_after_a_while_and_a_real_anchor_wins():
    """The original announces none; its map was never drawn."""
    peer = PeerMap("robot_0")
    tile = Tile("robot_0", (0,), 3, 4, np.zeros((2, 2), np.int8), 0.05, NO_BOOT)
    peer.add(tile, 5.0)
    assert not peer.expire(14.9) and peer.grid() is None
    assert peer.expire(15.0) and not peer.expire(99.0)
    assert corner(peer.grid()) == pytest.approx((0.2, 0.15)) and peer.wanted() is None
    run = peer.run
    assert peer.set_anchor(Anchor("robot_0", GridInfo(0, 0, 0.05, Pose(1.0, 2.0, 0.0)), (7, 7), 1), 20.0)
    assert peer.run != run and peer.wanted() == (0,)
    peer.add(tile, 21.0)
    assert corner(peer.grid()) == pytest.approx((1.2, 2.15))


def test_a_sender_that_tells_no_resolution_is_taken_for_one_with_the_usual_cells():
    """The original tells none, and every update of its map was refused."""
    peer = PeerMap("robot_0")
    tile = Tile("robot_0", (0,), 3, 4, np.zeros((2, 2), np.int8), 0.0, NO_BOOT)
    peer.add(tile, 0.0)
    assert peer.expire(10.0, usual=0.1) and peer.grid().info.resolution == 0.1
    peer.set_anchor(Anchor("robot_0", GridInfo(0, 0, 0.05), (7, 7), 1), 20.0)
    assert peer.add(tile, 21.0) and peer.grid().info.resolution == 0.05


def test_a_sender_that_names_its_run_announces_its_anchor_sooner_or_later():
    peer = PeerMap("robot_0")
    peer.add(Tile("robot_0", (0,), 3, 4, np.zeros((2, 2), np.int8), 0.05, BOOT), 0.0)
    assert not peer.expire(100.0)
    assert peer.wanted() == () and peer.run == 0


def test_the_run_is_learned_from_the_second_anchor():
    """An anchor that did not name the run stood for every run, but tiles that named theirs waited for ever."""
    sender, peer = sender_with(grid_at(0, 0, np.zeros((3, 3)))), PeerMap("robot_0")
    peer.set_anchor(sender.anchor()._replace(boot=NO_BOOT), 0.0)
    assert not peer.set_anchor(sender.anchor(), 0.0)
    assert peer.add(sender.changes()[0], 0.0)


# Sending again


def test_repeated_tiles_need_no_other_ones_even_when_they_are_halved():
    """Of an answer cut into pieces only the last one had the numbers: a lost piece of a group send was never missed."""
    sender = sender_with(grid_at(0, 0, np.zeros((64, 64))), None)
    (refused,) = sender.changes()
    assert sender.halve(refused)
    tiles = sender.repeated([0])
    assert [tile.numbers for tile in tiles] == [(1,), (2,), (3,), (0,)]
    for lost in range(4):
        peer = PeerMap("robot_0")
        peer.set_anchor(sender.anchor(), 0.0)
        for index, tile in enumerate(tiles):
            if index != lost:
                peer.add(tile, 0.0)
        assert peer.wanted() == tiles[lost].numbers
        told(peer, sender, sender.again(peer.wanted()))
        assert same_cells(peer.grid(), grid_at(0, 0, np.zeros((64, 64))))


def test_repeated_regions_within_another_one_go_with_it():
    cells = np.zeros((10, 12))
    sender = sender_with(grid_at(0, 0, cells))
    sender.changes()
    cells[4, 4] = 100
    sender.set_map(grid_at(0, 0, cells))
    sender.changes()
    assert [tile.numbers for tile in sender.repeated([1, 0, 77])] == [(0, 1)]


@given(st.integers(0, 2**32 - 1))
def test_every_beginning_of_an_answer_completes_the_numbers_that_came_with_it(seed):
    """An answer whose end is lost is of use: its numbers are not asked for again, and their cells are right."""
    random = np.random.default_rng(seed)
    cells = np.full((20, 20), UNKNOWN)
    sender, peer = MapSender("robot_0", 6, BOOT), PeerMap("robot_0")
    for _ in range(4):
        cells[random.random((20, 20)) < 0.1] = random.integers(-1, 101)
        sender.set_map(grid_at(0, 0, cells))
        sender.changes()
    tiles = sender.everything()
    peer.set_anchor(sender.anchor(), 0.0)
    for tile in tiles[: random.integers(0, len(tiles) + 1)]:
        peer.add(tile, 0.0)
    repair(sender, peer)
    assert same_cells(peer.grid(), grid_at(0, 0, cells))
