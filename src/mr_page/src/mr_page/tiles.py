"""A map as a page shows it: unknown, free or occupied cells in square tiles, of which only changed ones are sent."""

from __future__ import annotations

from collections import OrderedDict
from typing import Callable, Iterator, NamedTuple

import numpy as np

from mr_grid import GridInfo, OccupancyGrid, Pose

TILE = 64  # cells a side
TILE_OCTETS = TILE * TILE // 4  # four cells in an octet, the first in its lowest bits, row by row
UNKNOWN, FREE, OCCUPIED = 0, 1, 2
OCCUPIED_FROM = 50  # percent; what is below counts as free
MAX_TILES = 4096  # of one map, 4 MB; what lies in further ones is not shown
BLANK = bytes(TILE_OCTETS)
SAME_PLACE = 0.1  # cells that corners may be off the lattice by rounding
SAME_TURN = 1e-4  # rad

Place = tuple[int, int]  # of a tile: row and column, counted from the lattice's corner, may be negative


class Lattice(NamedTuple):
    """Where cells lie: `corner` is the pose of the outer corner of cell (0, 0) in the map's frame, `resolution` m."""

    resolution: float
    corner: Pose

    def offset(self, info: GridInfo) -> tuple[int, int] | None:
        """Row and column of a grid's first cell; None if its cells are no cells of this lattice."""
        turn = abs(np.remainder(info.origin.yaw - self.corner.yaw + np.pi, 2.0 * np.pi) - np.pi)
        if abs(info.resolution / self.resolution - 1.0) > 1e-6 or turn > SAME_TURN:
            return None
        local = self.corner.between(info.origin)
        column, row = local.x / self.resolution, local.y / self.resolution
        if max(abs(column - round(column)), abs(row - round(row))) > SAME_PLACE:
            return None
        return round(row), round(column)


class Changed(NamedTuple):
    """Tiles with their cells, the version up to which all are told with them, and how many more there are."""

    tiles: list[tuple[Place, bytes]]
    version: int
    rest: int


class TiledMap:
    """One map of one robot. `lattice_version` is another one when the map has begun anew, because its cells lie
    elsewhere than before. `clipped`: some of it is left out, see MAX_TILES.

    Args:
        next_version: gives growing numbers; a tile and the lattice have the number of their last change.
    """

    def __init__(self, next_version: Callable[[], int]) -> None:
        self.lattice: Lattice | None = None
        self.lattice_version = 0
        self.clipped = False
        self._next_version = next_version
        self._tiles: OrderedDict[Place, tuple[int, bytes]] = OrderedDict()  # version and cells, oldest change first
        self._offset = (0, 0)  # of the last whole grid
        self._info: GridInfo | None = None

    def __len__(self) -> int:
        return len(self._tiles)

    def take(self, grid: OccupancyGrid) -> None:
        """The whole map anew."""
        offset = self.lattice.offset(grid.info) if self.lattice else None
        if offset is None:
            offset = (0, 0)
            self.restart(Lattice(grid.resolution, grid.origin))
        self._offset, self._info = offset, grid.info
        found = dict(_tiles_of(classes_of(grid.cells), *offset))
        for place in [place for place, (_, cells) in self._tiles.items() if place not in found and cells != BLANK]:
            self.set(place, BLANK)
        for place, cells in found.items():
            self.set(place, cells)

    def patch(self, row: int, column: int, cells: np.ndarray) -> None:
        """A part (int8, rows x columns) of the last whole map, from its cell (row, column) on. ValueError without one
        or outside of it."""
        info = self._info
        if info is None:
            raise ValueError("a part of a map came before the map")
        if row < 0 or column < 0 or row + cells.shape[0] > info.height or column + cells.shape[1] > info.width:
            raise ValueError(f"a part of {cells.shape} cells at ({row}, {column}) is not in a map of {info.shape}")
        row, column = row + self._offset[0], column + self._offset[1]
        first = (row // TILE, column // TILE)
        end = (-(-(row + cells.shape[0]) // TILE), -(-(column + cells.shape[1]) // TILE))
        area = np.zeros(((end[0] - first[0]) * TILE, (end[1] - first[1]) * TILE), dtype=np.uint8)
        places = [(r, c) for r in range(first[0], end[0]) for c in range(first[1], end[1])]
        for r, c in places:
            top, left = (r - first[0]) * TILE, (c - first[1]) * TILE
            area[top : top + TILE, left : left + TILE] = unpacked(self.cells_at((r, c)))
        top, left = row - first[0] * TILE, column - first[1] * TILE
        area[top : top + cells.shape[0], left : left + cells.shape[1]] = classes_of(cells)
        for place, packed in _tiles_of(area, first[0] * TILE, first[1] * TILE, keep_blank=True):
            self.set(place, packed)

    def restart(self, lattice: Lattice) -> None:
        """Forget all tiles; cells lie on another lattice from now on."""
        self.lattice = lattice
        self.lattice_version = self._next_version()
        self._tiles.clear()
        self.clipped = False

    def set(self, place: Place, cells: bytes) -> None:
        """One tile; without effect if it is the same as before."""
        before = self.cells_at(place)
        if cells == before:
            return
        if place not in self._tiles and len(self._tiles) >= MAX_TILES:
            self.clipped = True
            return
        self._tiles[place] = (self._next_version(), cells)
        self._tiles.move_to_end(place)

    def cells_at(self, place: Place) -> bytes:
        return self._tiles.get(place, (0, BLANK))[1]

    def changed_since(self, version: int, most: int) -> Changed:
        """The tiles that have changed after `version`, the oldest change first, at most `most`."""
        newer: list[Place] = []
        for place in reversed(self._tiles):
            if self._tiles[place][0] <= version:
                break
            newer.append(place)
        chosen = newer[::-1][:most]
        told = self._tiles[chosen[-1]][0] if chosen else version
        return Changed([(place, self._tiles[place][1]) for place in chosen], told, len(newer) - len(chosen))


def classes_of(cells: np.ndarray) -> np.ndarray:
    """UNKNOWN, FREE or OCCUPIED (uint8) of the cells of an occupancy grid (int8, -1 unknown, percent)."""
    return (cells >= 0).view(np.uint8) + (cells >= OCCUPIED_FROM).view(np.uint8)


def _tiles_of(classes: np.ndarray, row: int, column: int, keep_blank: bool = False) -> Iterator[tuple[Place, bytes]]:
    """Packed tiles of classes whose first cell is (row, column) of the lattice; blank ones are left out."""
    if not classes.size:
        return
    top, left = row % TILE, column % TILE
    bottom, right = -(top + classes.shape[0]) % TILE, -(left + classes.shape[1]) % TILE
    padded = np.pad(classes, ((top, bottom), (left, right)))
    rows, columns = padded.shape[0] // TILE, padded.shape[1] // TILE
    quads = padded.reshape(padded.shape[0], -1, 4)
    octets = quads[..., 0] | quads[..., 1] << 2 | quads[..., 2] << 4 | quads[..., 3] << 6
    tiles = octets.reshape(rows, TILE, columns, TILE // 4).swapaxes(1, 2).reshape(rows, columns, TILE_OCTETS)
    known = np.ones((rows, columns), dtype=bool) if keep_blank else tiles.any(axis=2)
    for r, c in zip(*np.nonzero(known)):
        yield (row // TILE + int(r), column // TILE + int(c)), tiles[r, c].tobytes()


def unpacked(octets: bytes) -> np.ndarray:
    """Classes (TILE, TILE) of a tile."""
    packed = np.frombuffer(octets, dtype=np.uint8).reshape(TILE, -1, 1)
    return (packed >> np.array([0, 2, 4, 6], dtype=np.uint8) & 3).reshape(TILE, TILE)
