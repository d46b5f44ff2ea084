"""Kinds of buildings by name, as maps of them are registered. For worlds to drive in see `worlds`."""

from typing import Callable, Dict

import numpy as np

from .offices import clutter, equal_rooms, furnished_rooms, offices
from .open_spaces import caves, corridors, halls, loops
from .plan import FloorPlan
from .rooms import bare_rooms_plan, long_corridor_plan, symmetric_plan, turned_copies_plan

SHORTEST_M, LONGEST_M = 15.0, 100.0
"""Lengths of a building that can be asked for."""

Kind = Callable[[np.random.Generator, float], FloorPlan]
"""Draws a building of about that length (m) from the generator."""


def _of_rooms(draw: Callable[[np.random.Generator, int], FloorPlan], pitch: float = 4.1) -> Kind:
    return lambda random, length: draw(random, max(3, round(length / pitch)))


KINDS: Dict[str, Kind] = {
    "offices": offices,
    "furnished_rooms": furnished_rooms,
    "equal_rooms": equal_rooms,
    "halls": halls,
    "corridors": corridors,
    "caves": caves,
    "loops": loops,
    "clutter": clutter,
    "symmetric": _of_rooms(symmetric_plan),
    "turned_copies": _of_rooms(turned_copies_plan),
    "bare_rooms": _of_rooms(bare_rooms_plan),
    "long_corridor": _of_rooms(long_corridor_plan),
}


def generated(kind: str, seed: int, length: float = 26.0) -> FloorPlan:
    """The building of that kind, seed and length (m): the same for the same arguments. ValueError for a kind that is
    not among KINDS, or a length outside 15 m to 100 m."""
    if kind not in KINDS:
        raise ValueError(f"no kind of building is called {kind!r}; there are {', '.join(KINDS)}")
    if not SHORTEST_M <= length <= LONGEST_M:
        raise ValueError(f"a building is {SHORTEST_M:g} m to {LONGEST_M:g} m long, not {length:g} m")
    return KINDS[kind](np.random.default_rng(seed), length)
