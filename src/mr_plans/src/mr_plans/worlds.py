"""Worlds to drive in, by kind, seed and size: one connected space, closed outside, with places for robots to start."""

from dataclasses import dataclass
from difflib import get_close_matches
from typing import Callable, Dict, Optional, Tuple, Union

import numpy as np

from .caves import cave
from .drawing import Floor
from .offices import BLOCK_M, Room, blocks, draw_room
from .open_spaces import draw_halls, draw_loops, draw_maze
from .partition import irregular_rooms
from .passable import NARROW_CELLS, WIDE_CELLS, passable
from .plan import FloorPlan
from .wards import hospital, laboratory_room, narrow

SHORTEST_M, LONGEST_M = 15.0, 100.0
"""Bounds of the length of a world."""
SHALLOWEST_M = 10.0
_STREAM = 0x504C414E
"""Keeps plans apart from whatever else is drawn from the same seed."""

Draw = Callable[[np.random.Generator, float, float], Union[Floor, FloorPlan]]
"""Draws a building of that length and depth (m) from the generator."""


@dataclass(frozen=True)
class WorldKind:
    """`size`: length and depth (m) unless others are asked for; `shallowest`: least depth (m); `room`: cells that
    robots need to drive through an opening (see `passable`)."""

    what: str
    size: Tuple[float, float]
    draw: Draw
    shallowest: float = SHALLOWEST_M
    room: int = WIDE_CELLS


def _office(random: np.random.Generator, length: float, depth: float) -> Floor:
    def next_room() -> Room:
        return draw_room(random, random.uniform(2.6, 6.5), (0.8, 1.0))

    return blocks(random, length, depth, _corridors(depth), next_room)


def _equal_rooms(random: np.random.Generator, length: float, depth: float) -> Floor:
    room = draw_room(random, 0.1 * int(random.integers(32, 51)), (0.8, 1.0))
    return blocks(random, length, depth, _corridors(depth), lambda: room)


def _laboratory(random: np.random.Generator, length: float, depth: float) -> Floor:
    return blocks(random, length, depth, _corridors(depth), lambda: laboratory_room(random))


def _corridors(depth: float) -> int:
    return max(1, round(depth / BLOCK_M))


def _corridor(random: np.random.Generator, length: float, depth: float) -> Floor:
    floor, pitch = Floor(length, depth, solid=True), random.uniform(5.0, 7.5)
    columns, rows = max(2, round(length / pitch)), max(2, round(depth / pitch))
    draw_maze(floor, random, (columns, rows), (length / columns, depth / rows), random.uniform(1.6, 2.4))
    return floor


WORLD_KINDS: Dict[str, WorldKind] = {
    "office": WorldKind("rooms with furniture along corridors; doors of 0.8 m to 1.0 m", (26, 15), _office),
    "equalrooms": WorldKind("rooms that are copies of one another along corridors", (26, 15), _equal_rooms),
    "rooms": WorldKind("irregular rooms behind one another", (24, 16), irregular_rooms),
    "hospital": WorldKind("double corridors with rooms outside and between", (60, 22), hospital, 18.0),
    "laboratory": WorldKind("wide rooms with rows of benches", (32, 14), _laboratory),
    "hall": WorldKind("halls with pillars and stands, wider than a laser sees", (30, 20), draw_halls),
    "cave": WorldKind("a cave", (26, 18), cave),
    "loop": WorldKind("corridors around solid blocks with niches, rooms outside", (30, 20), draw_loops, 17.0),
    "corridor": WorldKind("a maze of corridors with loops and alcoves", (30, 18), _corridor),
    "narrow": WorldKind("corridors of 0.8 m to 1.1 m, doors of 0.6 m, niches", (18, 12), narrow, room=NARROW_CELLS),
}


def world_plan(kind: str, seed: int, size: Optional[Tuple[float, float]] = None) -> FloorPlan:
    """The world of that kind, seed (0 or above) and size (length, depth; m; by default the kind's own): the same for
    the same arguments. ValueError that names what cannot be."""
    length, depth = check_world(kind, seed, size)
    random = np.random.Generator(np.random.PCG64([_STREAM, list(WORLD_KINDS).index(kind), seed]))
    drawn = WORLD_KINDS[kind].draw(random, length, depth)
    return passable(drawn.plan() if isinstance(drawn, Floor) else drawn, WORLD_KINDS[kind].room)


def check_world(kind: str, seed: int, size: Optional[Tuple[float, float]] = None) -> Tuple[float, float]:
    """The size of such a world; ValueError that names what cannot be."""
    if kind not in WORLD_KINDS:
        meant = get_close_matches(kind, WORLD_KINDS, 1)
        hint = f", did you mean {meant[0]!r}?" if meant else f"; there are {', '.join(WORLD_KINDS)}"
        raise ValueError(f"no kind of world is called {kind!r}{hint}")
    if seed < 0:
        raise ValueError(f"the seed of a world is 0 or above, not {seed}")
    length, depth = size or WORLD_KINDS[kind].size
    if not SHORTEST_M <= length <= LONGEST_M:
        raise ValueError(f"a world is {SHORTEST_M:g} m to {LONGEST_M:g} m long, not {length:g} m")
    least = WORLD_KINDS[kind].shallowest
    if not least <= depth <= LONGEST_M:
        raise ValueError(f"a world of the kind {kind} is {least:g} m to {LONGEST_M:g} m deep, not {depth:g} m")
    return length, depth
