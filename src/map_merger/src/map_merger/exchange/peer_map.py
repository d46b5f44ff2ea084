"""The other side of the exchange: the map of one robot as far as it was received, and what is missing."""

from collections import deque
from contextlib import suppress
from dataclasses import replace
from typing import Deque, List, NamedTuple, Optional, Set, Tuple

import numpy as np

from mr_grid import GridError, GridInfo, OccupancyGrid

from ..grid import EMPTY_BOX, Box
from ..messages import NO_BOOT, USUAL_RESOLUTION_M, Anchor, Boot, Tile
from . import bounds
from .canvas import Canvas


class _Waiting(NamedTuple):
    """A tile that waits for its anchor, and since when (own clock, s)."""

    tile: Tile
    since: float


class _Claim(NamedTuple):
    """A former run that is heard again: how many anchors of it came, the first one when (own clock, s)."""

    boot: Boot
    first: float
    anchors: int


class PeerMap:
    """The map of one robot.

    A run of the robot has one anchor. Tiles and anchors of a former run come late and are ignored; runs are only ever
    compared for equality, since a robot's clock may be set back. Of each cell the newest word counts.
    """

    def __init__(self, robot: str) -> None:
        self._robot = robot
        self._anchor: Optional[Anchor] = None
        self._assumed = False
        self._canvas: Optional[Canvas] = None
        self._former: Deque[Boot] = deque(maxlen=bounds.MOST_FORMER_RUNS)
        self._claim: Optional[_Claim] = None
        self._waiting: Deque[_Waiting] = deque()
        self._waiting_cells = 0
        self._complete = 0
        self._later: Set[int] = set()
        self._expected = 0
        self._snapshot: Optional[OccupancyGrid] = None
        self._changed_box = EMPTY_BOX
        self.version = 0
        """Counts the changes of the map."""
        self.run = 0
        """Counts the anchors that began a map anew; 0 before the first."""

    @property
    def stored(self) -> int:
        """Number of cells that take memory."""
        return self._waiting_cells + (0 if self._canvas is None else self._canvas.stored)

    @property
    def boot(self) -> Boot:
        """Names the present run; NO_BOOT before the first anchor."""
        return NO_BOOT if self._anchor is None else self._anchor.boot

    @property
    def lattice(self) -> Optional[GridInfo]:
        """Corner from which cells are counted, and resolution; None before the first anchor. Fixed per run."""
        return None if self._anchor is None else replace(self._anchor.info, width=0, height=0)

    def set_anchor(self, anchor: Anchor, now: float, room: Optional[int] = None) -> bool:
        """Takes the anchor; True if it replaces another one: the robot restarted and its map starts anew.

        `room`: cells that may be stored. Tiles that waited and cannot belong to this map are dropped.
        """
        if self._anchor is not None and not self._assumed and self._same_run(self._anchor, anchor):
            if self._anchor.boot == NO_BOOT:
                self._anchor = anchor
            self._claim = None
            self._expect(anchor.updates)
            # What waits is of another run, and the robot does not speak of that one.
            self._waiting, self._waiting_cells = deque(), 0
            return False
        if anchor.boot in self._former and not self._believed(anchor.boot, now):
            return False
        return self._begin(anchor, now, room)

    def add(self, tile: Tile, now: float, room: Optional[int] = None) -> bool:
        """Takes a tile; True if the map changed. A tile of a run whose anchor is unknown waits for it, one of a former
        run is ignored.

        `room`: cells that may be stored. GridError if the tile does not fit into it or cannot belong to this map.
        """
        if tile.boot in self._former:
            return False
        if self._anchor is None or tile.boot not in (NO_BOOT, self._anchor.boot):
            self._wait(tile, now, room)
            return False
        self._claim = None
        resolution = self._anchor.info.resolution
        if tile.resolution and abs(tile.resolution - resolution) > 1e-3 * resolution:
            raise GridError(f"a tile with {tile.resolution:g} m cells for a map with {resolution:g} m cells")
        changed = self._write(tile, bounds.MOST_MAP_CELLS if room is None else room)
        self._record(tile)
        if not changed.empty:
            self._changed(changed)
        return not changed.empty

    def is_over(self, run: Boot) -> bool:
        """True for a former run."""
        return run in self._former

    def expire(self, now: float, room: Optional[int] = None, usual: float = USUAL_RESOLUTION_M) -> bool:
        """Ends waits that have been too long. True if the robot announces no anchor and therefore the corner of its
        map, in its own frame, was assumed to be at (0, 0).

        `usual`: m, edge of the cells of a robot that does not tell it.
        """
        if self._anchor is not None:
            while self._waiting and self._overdue(self._waiting[0], now):
                self._waiting_cells -= self._waiting.popleft().tile.cells.size
            return False
        nameless = [waiting for waiting in self._waiting if waiting.tile.boot == NO_BOOT]
        if not nameless or not self._overdue(nameless[0], now):
            return False
        info = GridInfo(0, 0, nameless[-1].tile.resolution or usual)
        self._begin(Anchor(self._robot, info, NO_BOOT), now, room)
        self._assumed = True
        return True

    def wanted(self) -> Optional[Tuple[int, ...]]:
        """Update numbers to ask for: () means everything, None that nothing is missing."""
        if self._anchor is None or self._waiting:
            return ()
        highest = max(self._expected - 1, max(self._later, default=-1))
        missing: List[int] = []
        for number in range(self._complete, highest + 1):
            if number not in self._later:
                missing.append(number)
                if len(missing) > bounds.MOST_REQUESTED:
                    return ()
        return tuple(missing) if missing else None

    def grid(self) -> Optional[OccupancyGrid]:
        """The known part of the map; None while nothing is known."""
        if self._snapshot is None and self._canvas is not None:
            self._snapshot = self._canvas.grid()
        return self._snapshot if self._snapshot is not None and self._snapshot.cells.size else None

    def cells(self, box: Box) -> np.ndarray:
        """Copy of the cells of a box (counted from the corner of `lattice`), unknown where nothing is known."""
        canvas = self._canvas or Canvas(GridInfo(0, 0, 1.0))
        return canvas.read(box)

    def take_changed(self) -> Optional[Box]:
        """Box around the cells of this run that changed since the last call, counted from the corner of `lattice`;
        None if none did."""
        box, self._changed_box = self._changed_box, EMPTY_BOX
        return None if box.empty else box

    def _begin(self, anchor: Anchor, now: float, room: Optional[int]) -> bool:
        restarted = self._anchor is not None
        if self._anchor is not None and self._anchor.boot not in (NO_BOOT, anchor.boot):
            self._former.append(self._anchor.boot)
        while anchor.boot in self._former:
            self._former.remove(anchor.boot)
        self._anchor, self._assumed, self._claim = anchor, False, None
        self._canvas = Canvas(anchor.info, stamped=True)
        self._complete, self._later, self._expected = 0, set(), 0
        self._expect(anchor.updates)
        self.run += 1
        self._changed_box = EMPTY_BOX
        self._changed(EMPTY_BOX)
        waiting, self._waiting, self._waiting_cells = self._waiting, deque(), 0
        for tile, _ in waiting:
            if tile.boot in (NO_BOOT, anchor.boot):
                # One that does not fit is missing from now on; asked for again, it is reported when it comes.
                with suppress(GridError):
                    self.add(tile, now, room)
        return restarted

    def _believed(self, boot: Boot, now: float) -> bool:
        """A former run that goes on while the present one is silent was the later one."""
        claim = self._claim
        if claim is None or claim.boot != boot:
            claim = _Claim(boot, now, 0)
        self._claim = claim._replace(anchors=claim.anchors + 1)
        return self._claim.anchors >= bounds.CLAIMS and abs(now - claim.first) >= bounds.CLAIM_S

    def _write(self, tile: Tile, room: int) -> Box:
        assert self._canvas is not None
        # An answer may overtake an update, or the other way round: of each cell the newest word counts.
        stamp = min(tile.updates, bounds.HIGHEST_NUMBER)
        write = self._canvas.write if tile.whole else self._canvas.write_known
        return write(tile.row, tile.column, tile.cells, room, stamp)

    def _changed(self, box: Box) -> None:
        self.version += 1
        self._snapshot = None
        self._changed_box = self._changed_box.union(box)

    @staticmethod
    def _same_run(known: Anchor, anchor: Anchor) -> bool:
        if NO_BOOT not in (known.boot, anchor.boot) and known.boot != anchor.boot:
            return False
        return replace(known.info, width=0, height=0) == replace(anchor.info, width=0, height=0)

    def _wait(self, tile: Tile, now: float, room: Optional[int]) -> None:
        self._waiting.append(_Waiting(tile, now))
        self._waiting_cells += tile.cells.size
        while self._waiting and (
            len(self._waiting) > bounds.MOST_WAITING_TILES
            or self._waiting_cells > bounds.MOST_WAITING_CELLS
            or self.stored > (bounds.MOST_MAP_CELLS if room is None else room)
        ):
            self._waiting_cells -= self._waiting.popleft().tile.cells.size

    @staticmethod
    def _overdue(waiting: _Waiting, now: float) -> bool:
        # After the clock jumped back nobody knows how long it has been.
        return not 0.0 <= now - waiting.since < bounds.LONGEST_WAIT_S

    def _expect(self, updates: int) -> None:
        self._expected = max(self._expected, min(updates, bounds.HIGHEST_NUMBER))

    def _record(self, tile: Tile) -> None:
        self._later.update(number for number in tile.numbers if self._complete <= number < bounds.HIGHEST_NUMBER)
        self._expect(tile.updates)
        while self._complete in self._later:
            self._later.remove(self._complete)
            self._complete += 1
