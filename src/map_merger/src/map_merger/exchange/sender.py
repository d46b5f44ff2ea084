"""Own side of the exchange: what of the local map others have not been told, cut into numbered tiles.

Each tile that is sent to the group has a number of its own, so that the loss of any tile shows as a gap.
"""

from typing import Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from mr_grid import UNKNOWN, GridError, OccupancyGrid

from ..grid import EMPTY_BOX, Box, bounding_box, changed_box, cropped, known_box, offset_between, union_of
from ..messages import Anchor, Boot, Tile
from . import bounds
from .canvas import BLOCK, Canvas


class _Untold(NamedTuple):
    """Cells that changed, int8 as others know them and as they are, in a box of the run's cells; `reached`: all cells
    that were ever known."""

    box: Box
    told: np.ndarray
    present: np.ndarray
    reached: Box

    @property
    def changed(self) -> int:
        return int(np.count_nonzero(self.told != self.present))


class MapSender:
    """Finds changed cells, numbers them, and answers requests.

    A tile of changes holds the cells that changed only, which is little when compressed. Where known cells became
    unknown, and in answers, tiles are whole (see messages.Tile), so that a wall that was taken back disappears.
    """

    def __init__(self, robot: str, tile_size: Optional[int], boot: Boot) -> None:
        """`tile_size` in cells, None = everything in one tile. `boot` names this run."""
        self._robot = robot
        self._tile_size = tile_size
        self._largest_taken = bounds.MOST_MAP_CELLS
        self._boot = boot
        self._told: Optional[Canvas] = None
        self._reached = EMPTY_BOX
        self._local: Optional[OccupancyGrid] = None
        self._dirty = False
        self._untold: Optional[_Untold] = None
        self._known = 0
        self._boxes: Dict[int, Box] = {}
        self._next = 0

    @property
    def updates(self) -> int:
        """Numbers used so far."""
        return self._next

    def anchor(self) -> Optional[Anchor]:
        """The anchor of this run; None before the first map."""
        return None if self._told is None else Anchor(self._robot, self._told.anchor, self._boot, self._next)

    @property
    def boot(self) -> Boot:
        """Names this run."""
        return self._boot

    def resume(self, anchor: Anchor) -> None:
        """Before the first map: goes on with this run, of whose cells nothing is known any more."""
        self._boot, self._told, self._next = anchor.boot, Canvas(anchor.info), anchor.updates

    def check(self, grid: OccupancyGrid) -> None:
        """GridError if the map's resolution or heading differs from the first one's."""
        if self._told is None:
            self._told = Canvas(grid.info)
        offset_between(grid.info, self._told.anchor)

    def set_map(self, grid: OccupancyGrid) -> None:
        """Takes the present map. GridError as by `check`."""
        self.check(grid)
        self._local = grid
        self._dirty = True

    def changes(self, worth: Callable[[int, int], bool] = lambda changed, known: True) -> List[Tile]:
        """Tiles with what changed since the last ones, each with its own number; none if nothing did, or if it is not
        `worth` it by the numbers of changed cells and of those known to the others.

        GridError if the map is larger than what others take.
        """
        if self._dirty:
            self._untold, self._dirty = self._compared(), False
        untold = self._untold
        due = worth(0 if untold is None else untold.changed, self._known)
        if not due or untold is None or self._told is None:
            return []
        _check_size(untold.reached)
        self._told.write(untold.box.top, untold.box.left, untold.present, bounds.MOST_MAP_CELLS)
        self._reached, self._untold = untold.reached, None
        self._known += int(np.count_nonzero(untold.present != UNKNOWN) - np.count_nonzero(untold.told != UNKNOWN))
        return self._tiles_of(untold)

    def _compared(self) -> Optional["_Untold"]:
        """What of the present map the others do not know."""
        assert self._told is not None and self._local is not None
        rows, columns = offset_between(self._local.info, self._told.anchor)
        reached = known_box(self._local).shifted(rows, columns).union(self._reached)
        present, told = cropped(self._local, reached.shifted(-rows, -columns)).cells, self._told.read(reached)
        box = changed_box(told, present)
        if box.empty:
            return None
        return _Untold(box.shifted(reached.top, reached.left), told[box.slices()], present[box.slices()], reached)

    def everything(self) -> List[Tile]:
        """All cells that were ever known, with a margin; together the tiles carry all numbers (no tiles before the
        first update)."""
        if self._next == 0:
            return []
        return self._answer(list(self._cut(self._reached.grown(bounds.FULL_MAP_MARGIN))), range(self._next))

    def again(self, numbers: Iterable[int]) -> List[Tile]:
        """Present content of the regions of these updates. Numbers that were never used are left out."""
        known = sorted({number for number in numbers if 0 <= number < self._next})
        if not known:
            return []
        if any(number not in self._boxes for number in known):
            return self.everything()
        union = union_of(self._boxes[number] for number in known)
        apart = [box for box, _ in self._regions(known)]
        together = sum(box.area for box in apart) > union.area or len(apart) > bounds.MOST_TILES
        parts = [part for box in ([union] if together else apart) for part in self._cut(box)]
        return self._answer(parts, known)

    def last(self) -> List[Tile]:
        """The region of the last update."""
        return self.again([self._next - 1])

    def repeated(self, numbers: Iterable[int]) -> List[Tile]:
        """Present content of the regions of these updates for the group: no tile needs another one. A region that is
        too large by now is cut, and the new pieces have new numbers. Regions that are forgotten are left out."""
        tiles: List[Tile] = []
        for box, inside in self._regions([number for number in sorted(numbers) if number in self._boxes]):
            *pieces, last = self._cut(box)
            tiles.extend(self._numbered(piece) for piece in pieces)
            self._boxes.update((number, last) for number in inside if pieces and number in self._boxes)
            tiles.append(self._tile(last, tuple(inside)))
        return tiles

    def halve(self, refused: Tile) -> bool:
        """From now on tiles have at most half the edge of this one, which was too large to be sent. False if it is too
        small for that."""
        edge = max(refused.cells.shape) // 2
        if edge < bounds.SMALLEST_TILE:
            return False
        self._largest_taken = min(edge, self._largest_taken)
        return True

    def _regions(self, numbers: Sequence[int]) -> List[Tuple[Box, List[int]]]:
        """The regions of the numbers, each with the numbers in it; one that lies within another goes with that."""
        regions: List[Tuple[Box, List[int]]] = []
        for number in sorted(numbers, key=lambda number: (-self._boxes[number].area, number)):
            box = self._boxes[number]
            for around, inside in regions:
                if around.contains(box):
                    inside.append(number)
                    break
            else:
                regions.append((box, [number]))
        return regions

    def _tiles_of(self, untold: "_Untold") -> List[Tile]:
        changed = untold.told != untold.present
        lost = changed & (untold.present == UNKNOWN)
        tiles = []
        for part in self._cut(Box(0, 0, *changed.shape)):
            box = bounding_box(changed[part.slices()])
            if box.empty:
                continue
            box = box.shifted(part.top, part.left)
            inside = box.slices()
            cells = None if lost[inside].any() else np.where(changed[inside], untold.present[inside], np.int8(UNKNOWN))
            tiles.append(self._numbered(box.shifted(untold.box.top, untold.box.left), cells))
        return tiles

    def _numbered(self, box: Box, cells: Optional[np.ndarray] = None) -> Tile:
        number = self._next
        self._next += 1
        self._boxes[number] = box
        self._boxes.pop(number - bounds.MOST_BOXES, None)
        return self._tile(box, (number,), cells)

    def _answer(self, parts: List[Box], numbers: Sequence[int]) -> List[Tile]:
        """Whoever receives a beginning of the tiles, in order, has all of the numbers that came with them."""
        completed: List[List[int]] = [[] for _ in parts]
        for number, index in zip(numbers, self._last_parts(parts, numbers)):
            completed[index].append(number)
        return [self._tile(part, tuple(inside)) for part, inside in zip(parts, completed)]

    def _last_parts(self, parts: List[Box], numbers: Sequence[int]) -> List[int]:
        """Index of the last part that touches the region of each number; forgotten regions may be anywhere."""
        anywhere = union_of(parts)
        boxes = [self._boxes.get(number, anywhere) for number in numbers]
        top, left, bottom, right = (np.array([part.edges for part in parts], np.int64).T)[:, None, :]
        first_row, first_column, last_row, last_column = np.array([box.edges for box in boxes], np.int64).T[:, :, None]
        touched = (first_row < bottom) & (top < last_row) & (first_column < right) & (left < last_column)
        return (len(parts) - 1 - touched[:, ::-1].argmax(axis=1)).tolist()

    def _tile(self, box: Box, numbers: Tuple[int, ...], cells: Optional[np.ndarray] = None) -> Tile:
        """The known cells of a tile, or a whole one with its present content."""
        assert self._told is not None
        return Tile(
            self._robot,
            numbers,
            box.top,
            box.left,
            self._told.read(box) if cells is None else cells,
            self._told.anchor.resolution,
            self._boot,
            self._next,
            cells is None,
        )

    def _cut(self, box: Box) -> Iterable[Box]:
        if box.empty:
            return []
        size = self._tile_size or max(box.shape)
        while -(-box.shape[0] // size) * -(-box.shape[1] // size) > bounds.MOST_TILES:
            size *= 2
        return box.tiles(min(size, self._largest_taken))


def _check_size(reached: Box) -> None:
    """GridError if others cannot store what answers carry."""
    stored = reached.grown(bounds.FULL_MAP_MARGIN).aligned(BLOCK)
    if stored.area > bounds.MOST_MAP_CELLS:
        rows, columns = stored.shape
        raise GridError(f"others would have to store {columns} x {rows} cells, and take {bounds.MOST_MAP_CELLS}")
