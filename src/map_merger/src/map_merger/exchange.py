"""Exchange of map changes: numbered updates, tiles counted from an anchor, and repair of what was lost.

Each tile that is sent to the group has a number of its own, so that the loss of any tile shows as a gap.
"""

from collections import deque
from contextlib import suppress
from dataclasses import replace
from typing import Deque, Dict, Iterable, List, Optional, Set, Tuple

from .grid import UNKNOWN, Box, Canvas, Grid, GridError, bounding_box, full_box, offset_between, union_of
from .messages import NO_BOOT, Anchor, Boot, Tile

MOST_BOXES = 4096
"""Updates whose region is remembered; older ones are answered with everything."""
MOST_TILES = 512
"""Tiles in one go; the tile edge is doubled until they suffice, unless that is too large to be sent."""
SMALLEST_TILE = 16
"""Tiles are not halved below this edge in cells."""
MOST_REQUESTED = 200
"""Numbers in one request; with more gaps everything is asked for."""
MOST_MAP_CELLS = 8_000_000
"""Cells of the known region of one map (140 m x 140 m of 0.05 m); larger ones are not exchanged."""
MOST_WAITING_CELLS = 2_000_000
"""Cells of tiles that wait for their anchor."""
MOST_WAITING_TILES = 512
"""Tiles that wait for their anchor."""
HIGHEST_NUMBER = 10_000_000
"""Larger update numbers can only be garbage."""
FULL_MAP_MARGIN = 5
"""Cells around the known region in the answer to a full request (contract 2.4)."""


class MapSender:
    """Own side: finds changed cells, numbers them, and answers requests."""

    def __init__(self, robot: str, tile_size: Optional[int], boot: Boot) -> None:
        """`tile_size` in cells, None = everything in one tile. `boot` names this run."""
        self._robot = robot
        self._tile_size = tile_size
        self._largest_taken = MOST_MAP_CELLS
        self._boot = boot
        self._canvas: Optional[Canvas] = None
        self._local: Optional[Grid] = None
        self._dirty = False
        self._boxes: Dict[int, Box] = {}
        self._next = 0

    @property
    def updates(self) -> int:
        """Numbers used so far."""
        return self._next

    def anchor(self) -> Optional[Anchor]:
        """The anchor of this run; None before the first map."""
        return None if self._canvas is None else Anchor(self._robot, self._canvas.anchor, self._boot, self._next)

    def set_map(self, grid: Grid) -> None:
        """Takes the present local map. GridError if its resolution or heading differs from the first one's."""
        if self._canvas is None:
            self._canvas = Canvas(grid.info)
        offset_between(grid.info, self._canvas.anchor)
        self._local = grid
        self._dirty = True

    def changes(self) -> List[Tile]:
        """Tiles with what changed since the last call, each with its own number; none if nothing did.

        GridError if the map is larger than what others take.
        """
        if self._canvas is None or self._local is None or not self._dirty:
            return []
        self._dirty = False
        rows, columns = offset_between(self._local.info, self._canvas.anchor)
        everything = full_box(self._local.info)
        before = self._canvas.read(everything.shifted(rows, columns))
        changed = (self._local.cells != UNKNOWN) & (self._local.cells != before)
        self._canvas.write_known(rows, columns, self._local.cells, MOST_MAP_CELLS)
        tiles = []
        for part in self._cut(bounding_box(changed)):
            if changed[part.slices()].any():
                tiles.append(self._numbered(part.shifted(rows, columns)))
        return tiles

    def everything(self) -> List[Tile]:
        """All known cells with a margin; the last tile carries all numbers (empty before the first update)."""
        if self._canvas is None or self._next == 0:
            return []
        return self._answer(self._canvas.known_box().grown(FULL_MAP_MARGIN), range(self._next))

    def again(self, numbers: Iterable[int]) -> List[Tile]:
        """Present content of the regions of these updates. Numbers that were never used are left out."""
        known = sorted({number for number in numbers if 0 <= number < self._next})
        if not known:
            return []
        if any(number not in self._boxes for number in known):
            return self.everything()
        return self._answer(union_of(self._boxes[number] for number in known), known)

    def last(self) -> List[Tile]:
        """The region of the last update."""
        return self.again([self._next - 1])

    def halve(self, refused: Tile) -> bool:
        """From now on tiles have at most half the edge of this one, which was too large to be sent. False if it is too
        small for that."""
        edge = max(refused.cells.shape) // 2
        if edge < SMALLEST_TILE:
            return False
        self._largest_taken = min(edge, self._largest_taken)
        return True

    def _numbered(self, box: Box) -> Tile:
        number = self._next
        self._next += 1
        self._boxes[number] = box
        self._boxes.pop(number - MOST_BOXES, None)
        return self._tile(box, (number,))

    def _answer(self, box: Box, numbers: Iterable[int]) -> List[Tile]:
        # The numbers are in the last tile only: whoever receives it in order has the others too.
        parts = list(self._cut(box))
        return [self._tile(part, tuple(numbers) if part is parts[-1] else ()) for part in parts]

    def _tile(self, box: Box, numbers: Tuple[int, ...]) -> Tile:
        assert self._canvas is not None
        return Tile(
            self._robot,
            numbers,
            box.top,
            box.left,
            self._canvas.read(box),
            self._canvas.anchor.resolution,
            self._boot,
            self._next,
        )

    def _cut(self, box: Box) -> Iterable[Box]:
        if box.empty:
            return []
        size = self._tile_size or max(box.shape)
        while -(-box.shape[0] // size) * -(-box.shape[1] // size) > MOST_TILES:
            size *= 2
        return list(box.tiles(min(size, self._largest_taken)))


class PeerMap:
    """The other side: the map of one robot as far as it was received, and what is missing."""

    def __init__(self, robot: str) -> None:
        self._robot = robot
        self._anchor: Optional[Anchor] = None
        self._canvas: Optional[Canvas] = None
        self._waiting: Deque[Tile] = deque()
        self._waiting_cells = 0
        self._complete = 0
        self._later: Set[int] = set()
        self._expected = 0
        self._snapshot: Optional[Grid] = None
        self.version = 0
        """Counts the changes of the map."""

    @property
    def stored(self) -> int:
        """Number of cells that take memory."""
        return self._waiting_cells + (0 if self._canvas is None else self._canvas.stored)

    def set_anchor(self, anchor: Anchor, room: int = MOST_MAP_CELLS) -> bool:
        """Takes the anchor; True if it replaces another one: the robot restarted and its map starts anew.

        `room`: cells that may be stored. Tiles that waited and cannot belong to this map are dropped.
        """
        self._expected = max(self._expected, min(anchor.updates, HIGHEST_NUMBER))
        if self._anchor is not None and self._same_run(anchor):
            return False
        restarted = self._anchor is not None
        self._anchor = anchor
        self._canvas = Canvas(anchor.info, stamped=True)
        self._complete, self._expected = 0, min(anchor.updates, HIGHEST_NUMBER)
        self._later = set()
        self._changed()
        waiting, self._waiting, self._waiting_cells = self._waiting, deque(), 0
        for tile in waiting:
            if tile.boot in (NO_BOOT, anchor.boot):
                # One that does not fit is missing from now on; asked for again, it is reported when it comes.
                with suppress(GridError):
                    self.add(tile, room)
        return restarted

    def add(self, tile: Tile, room: int = MOST_MAP_CELLS) -> bool:
        """Takes a tile; True if the map changed. A tile of a run whose anchor is unknown waits for it.

        `room`: cells that may be stored. GridError if the tile does not fit into it or cannot belong to this map.
        """
        if self._anchor is None or (tile.boot != NO_BOOT and tile.boot != self._anchor.boot):
            self._wait(tile, room)
            return False
        assert self._canvas is not None
        if abs(tile.resolution - self._anchor.info.resolution) > 1e-3 * self._anchor.info.resolution:
            raise GridError(
                f"a tile with {tile.resolution:g} m cells for a map with {self._anchor.info.resolution:g} m cells"
            )
        # An answer may overtake an update, or the other way round: of each cell the newest word counts.
        changed = not self._canvas.write_known(
            tile.row, tile.column, tile.cells, room, min(tile.updates, HIGHEST_NUMBER)
        ).empty
        self._record(tile)
        if changed:
            self._changed()
        return changed

    def wanted(self) -> Optional[Tuple[int, ...]]:
        """Update numbers to ask for: () means everything, None that nothing is missing."""
        if self._anchor is None or self._waiting:
            return ()
        highest = max(self._expected - 1, max(self._later, default=-1))
        missing: List[int] = []
        for number in range(self._complete, highest + 1):
            if number not in self._later:
                missing.append(number)
                if len(missing) > MOST_REQUESTED:
                    return ()
        return tuple(missing) if missing else None

    def grid(self) -> Optional[Grid]:
        """The known part of the map; None while nothing is known."""
        if self._snapshot is None and self._canvas is not None and not self._canvas.known_box().empty:
            self._snapshot = self._canvas.grid()
        return self._snapshot

    def _changed(self) -> None:
        self.version += 1
        self._snapshot = None

    def _same_run(self, anchor: Anchor) -> bool:
        known = self._anchor
        assert known is not None
        if NO_BOOT not in (known.boot, anchor.boot) and known.boot != anchor.boot:
            return False
        return replace(known.info, width=0, height=0) == replace(anchor.info, width=0, height=0)

    def _wait(self, tile: Tile, room: int) -> None:
        self._waiting.append(tile)
        self._waiting_cells += tile.cells.size
        while self._waiting and (
            len(self._waiting) > MOST_WAITING_TILES or self._waiting_cells > MOST_WAITING_CELLS or self.stored > room
        ):
            self._waiting_cells -= self._waiting.popleft().cells.size

    def _record(self, tile: Tile) -> None:
        self._later.update(number for number in tile.numbers if self._complete <= number < HIGHEST_NUMBER)
        self._expected = max(self._expected, min(tile.updates, HIGHEST_NUMBER))
        while self._complete in self._later:
            self._later.remove(self._complete)
            self._complete += 1
