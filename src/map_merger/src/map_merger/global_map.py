"""The global map of a robot: its local map and those of the others as one, on the lattice of the local map.

State in, changes out: each change marks the tiles that it can touch, and `render` computes these anew. The map depends
on what was set, not on the order. How cells are weighed is in `weighing`, which obstacles are robots in `ghosts`.
"""

from dataclasses import replace
from enum import Enum
from typing import Collection, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from mr_grid import UNKNOWN, GridInfo, OccupancyGrid, Pose

from . import ghosts, weighing
from .board import Board, DirtyTiles
from .drawing import whole_shift
from .grid import EMPTY_BOX, Box, full_box, union_of, window
from .layers import Layer, difference
from .places import Places, blocks
from .robot_size import USUAL_SIZE, RobotSize

GROWTH_BLOCK = 20
"""The global map grows beyond the local one by whole blocks of cells, so that its size does not change with every
refinement."""
MOST_GLOBAL_CELLS = 16_000_000
"""Others' maps may not make the global map larger than this (200 m x 200 m of 0.05 m)."""


class Policy(Enum):
    """What the local map's known cells are worth. STRICT: they stay as they are, but for robots in them. EVIDENCE: they
    count like those of any other map."""

    STRICT = "strict"
    EVIDENCE = "evidence"


class Update(NamedTuple):
    """A new global map, and the box of its cells that may differ from the one before."""

    grid: OccupancyGrid
    changed: Box


class GlobalMap:
    """The maps, transforms and tracks of a team as one map. Grids that are passed in may not be changed afterwards."""

    def __init__(self, name: str, size: RobotSize, policy: Policy = Policy.STRICT) -> None:
        """`name`: the robot whose map the local one is. `size`: of the robots of the team."""
        self._name, self._policy, self._size = name, policy, size
        self._local: Optional[OccupancyGrid] = None
        self._at = EMPTY_BOX  # of the local map on the lattice, which counts from the corner of the first local map
        self._lattice = GridInfo(0, 0, 1.0)
        self._layers: Dict[str, Layer] = {}
        self._places: Dict[str, Places] = {}
        self._drawn: Tuple[str, ...] = ()
        self._board, self._dirty = Board(), DirtyTiles()
        self._published: Optional[OccupancyGrid] = None

    @property
    def left_out(self) -> Tuple[str, ...]:
        """Robots whose maps would have made the last rendered map larger than MOST_GLOBAL_CELLS, and are not in it."""
        return tuple(name for name in sorted(self._layers) if name not in self._drawn)

    def set_local(self, grid: OccupancyGrid) -> None:
        """The local map; it may grow to all sides. Another resolution, heading, a shift by a part of a cell or by
        more than its size draws everything anew."""
        before, shift = self._local, whole_shift(grid.info, self._lattice)
        self._local = grid
        relative = None if before is None else whole_shift(before.info, grid.info)
        if before is None or shift is None or relative is None or _apart(before.info, grid.info, relative):
            self._start_anew(grid)
            return
        self._at = full_box(grid.info).shifted(*shift)
        self._mark(difference(before, grid, relative).shifted(*shift))

    def set_layer(
        self, name: str, source: OccupancyGrid, version: object, transform: Pose, changed: Optional[Box] = None
    ) -> None:
        """The map of another robot; `transform`: its frame -> own frame. Nothing happens while `version` is the one
        that was drawn and the transform hardly moved (drawing.STILL_M, STILL_RAD).

        `changed`: the cells of the source that may differ from those of the version that was set before; None: the two
        are compared. ValueError for the own name.
        """
        if name == self._name:
            raise ValueError(f"the map of {name} is the local one")
        layer = self._layers.setdefault(name, Layer())
        if not layer.follows(version, transform):
            self._mark(layer.set(source, version, transform, changed, self._lattice, self._most_cells()))

    def remove_layer(self, name: str) -> None:
        """The robot's map does not count any more; nothing happens if there is none."""
        if name in self._layers:
            self._mark(self._layers[name].box)
            del self._layers[name]

    def set_places(self, name: str, places: np.ndarray) -> None:
        """Where a robot (also the own one) has been: (n, 2) in m, own frame, oldest first; none: nothing is known.

        Places that moved by less than places.SAME_PLACE_M stay where they are. ValueError for another shape or what is
        no number.
        """
        changed = self._places.setdefault(name, Places()).set(places, self._lattice)
        if self._local is None:
            return
        margin = ghosts.effect(self._lattice.resolution, self._size)
        for block in blocks(changed):
            box = block.grown(margin)
            maps = self._maps(box, self._layers).values()
            resolution = self._lattice.resolution
            if any(ghosts.possible(cells, changed, box, resolution, self._size) for cells in maps):
                self._dirty.add(box, weighing.reach(len(self._layers)))

    def render(self) -> Optional[Update]:
        """The map now; None without a local map, or if it is the one that was returned before."""
        if self._local is None:
            return None
        self._choose_layers()
        changed = union_of([self._computed(box) for box in self._dirty.taken()])
        outer = self._extent(self._drawn)
        info = window(self._local.info, outer.shifted(-self._at.top, -self._at.left))
        if self._published is not None and self._published.info == info:
            changed = changed.intersection(outer)
            if changed.empty:
                return None
        else:
            changed = outer
        self._published = OccupancyGrid(info, self._board.read(outer).copy())
        return Update(self._published, changed.shifted(-outer.top, -outer.left))

    def _start_anew(self, local: OccupancyGrid) -> None:
        self._lattice = replace(local.info, width=0, height=0)
        self._at = full_box(local.info)
        self._board, self._published = Board(), None
        self._mark(self._at)
        for layer in self._layers.values():
            layer.draw_anew(self._lattice, self._most_cells())
            self._mark(layer.box)
        for track in self._places.values():
            track.draw(self._lattice)

    def _mark(self, box: Box) -> None:
        if not box.empty and self._local is not None:
            # One more for the map that changed, which may have known something here before.
            self._dirty.add(box, self._reach(box, self._layers, more=1))

    def _reach(self, box: Box, names: Collection[str], more: int = 0) -> int:
        """Cells from the box within which cells depend on one another by these maps and so many more; such that know
        nothing near pass nothing on."""
        beside = ghosts.reach(self._lattice.resolution, self._size)
        around = box.grown(weighing.reach(len(names) + more) + beside)
        near = sum(not self._layers[name].box.intersection(around).empty for name in names)
        return weighing.reach(near + more) + beside

    def _most_cells(self) -> int:
        return max(MOST_GLOBAL_CELLS, self._at.area)

    def _choose_layers(self) -> None:
        """Those with which the map is not too large, by name."""
        most = self._most_cells()
        chosen: List[str] = []
        for name in sorted(self._layers):
            if not self._layers[name].too_large and self._extent([*chosen, name]).area <= most:
                chosen.append(name)
        for name in set(chosen).symmetric_difference(self._drawn):
            if name in self._layers:
                self._mark(self._layers[name].box)
        if bool(chosen) != bool(self._drawn):
            # A map alone stays as it is.
            self._mark(self._at)
        self._drawn = tuple(chosen)

    def _extent(self, names: Sequence[str]) -> Box:
        """The cells of the global map with these layers."""
        foreign = union_of(self._layers[name].box for name in names)
        if self._at.contains(foreign):
            return self._at
        # Whole blocks, counted from the corner of the local map.
        blocks = foreign.shifted(-self._at.top, -self._at.left).aligned(GROWTH_BLOCK)
        return self._at.union(blocks.shifted(self._at.top, self._at.left))

    def _computed(self, box: Box) -> Box:
        """Computes the cells of the box; returns the box of those that changed."""
        around = box.grown(self._reach(box, self._drawn))
        maps = self._maps(around, self._drawn)
        places = {name: each.cells for name, each in self._places.items()}
        maps = ghosts.without_ghosts(maps, places, around, self._lattice.resolution, self._size)
        foreign = [maps[name] for name in self._drawn if name in maps]
        local = maps[self._name]
        cells = weighing.weighed(local, foreign, self._policy is Policy.STRICT) if self._drawn else local
        return self._board.write(box, cells[box.shifted(-around.top, -around.left).slices()])

    def _maps(self, box: Box, names: Iterable[str]) -> Dict[str, np.ndarray]:
        """The local map and those of these others that know something in the box."""
        assert self._local is not None
        local = np.full(box.shape, UNKNOWN, np.int8)
        inside = box.intersection(self._at)
        if not inside.empty:
            target = inside.shifted(-box.top, -box.left).slices()
            local[target] = self._local.cells[inside.shifted(-self._at.top, -self._at.left).slices()]
        maps = {self._name: local}
        for name in names:
            layer = self._layers[name]
            if layer.box.intersection(box).empty:
                continue
            cells = layer.board.read(box)
            if (cells != UNKNOWN).any():
                maps[name] = cells
        return maps


def _apart(before: GridInfo, after: GridInfo, shift: Tuple[int, int]) -> bool:
    """Whether grids on one lattice, the first one's corner at `shift` of the second, have no cell in common."""
    return full_box(before).shifted(*shift).intersection(full_box(after)).empty


def merged(local: OccupancyGrid, others: Sequence[Tuple[OccupancyGrid, Pose]]) -> OccupancyGrid:
    """All maps as one in the frame and on the lattice of the local one, by evidence; `others` with their transforms to
    the local frame."""
    together = GlobalMap("", USUAL_SIZE, Policy.EVIDENCE)
    together.set_local(local)
    for number, (grid, transform) in enumerate(others):
        together.set_layer(f"{number:06d}", grid, 0, transform)
    update = together.render()
    assert update is not None
    return update.grid
