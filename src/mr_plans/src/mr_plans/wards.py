"""Buildings along corridors that offices are not: hospitals, laboratories, narrow old houses."""

from typing import List

import numpy as np

from .drawing import RESOLUTION, WALL_M, Floor
from .offices import Box, Room, draw_room, draw_row

_WING_M = 24.0
"""Depth of two corridors with four rows of rooms."""
_BETWEEN_CROSSINGS_M = 22.0
_CROSSING_M = 2.4


def hospital(random: np.random.Generator, length: float, depth: float) -> Floor:
    """Two corridors side by side with rooms outside and a core of rooms between them, joined at both ends and every
    22 m; more such wings behind one another if it is deep."""
    floor = Floor(length, depth)
    wings, crossings = max(1, round(depth / _WING_M)), _crossings(length)
    corridors = [
        corridor
        for number in range(wings)
        for corridor in _wing(random, floor, number * depth / wings, depth / wings, crossings)
    ]
    for corridor in corridors:
        floor.open(0.0, corridor.bottom, length, corridor.top)
    for left in crossings:
        floor.open(left, corridors[0].bottom, left + _CROSSING_M, corridors[-1].top)
    return floor


def _crossings(length: float) -> List[float]:
    """Left sides of the cross corridors."""
    count = max(2, 1 + round(length / _BETWEEN_CROSSINGS_M))
    return [number * (length - _CROSSING_M) / (count - 1) for number in range(count)]


def _wing(random: np.random.Generator, floor: Floor, bottom: float, depth: float, crossings: List[float]) -> List[Box]:
    """Draws four rows of rooms and returns the two corridors."""
    width = random.uniform(2.0, 2.4)
    room = 0.25 * (depth - 2.0 * width)
    low, middle, high = bottom + room, bottom + 0.5 * depth, bottom + depth - room

    def next_room() -> Room:
        return draw_room(random, random.uniform(3.2, 5.0), (1.0, 1.2))

    for left, right in zip([crossing + _CROSSING_M for crossing in crossings], crossings[1:]):
        draw_row(floor, left, right, bottom, low, next_room)
        draw_row(floor, left, right, middle, low + width, next_room)
        draw_row(floor, left, right, middle, high - width, next_room)
        draw_row(floor, left, right, bottom + depth, high, next_room)
    return [Box(0.0, low, floor.length, low + width), Box(0.0, high - width, floor.length, high)]


def laboratory_room(random: np.random.Generator) -> Room:
    """A wide room with rows of benches, every second one of them an island."""
    width = random.uniform(5.5, 9.5)
    bench, aisle = random.uniform(0.7, 0.9), random.uniform(1.2, 1.5)
    benches = []
    for number, left in enumerate(np.arange(aisle, width - aisle - bench, bench + aisle)):
        bottom = WALL_M if number % 2 else random.uniform(1.1, 1.4)
        benches.append(Box(float(left), bottom, float(left) + bench, random.uniform(2.8, 3.8)))
    door = random.uniform(0.9, 1.0)
    return Room(width, random.uniform(0.3, width - door - 0.3), door, tuple(benches))


def narrow(random: np.random.Generator, length: float, depth: float) -> Floor:
    """Thick walls: corridors of 0.8 m to 1.1 m, in which robots cannot pass one another, rooms with doors of 0.6 m
    and niches."""
    floor = Floor(length, depth, solid=True)
    rows = max(1, round(depth / 9.0))
    block = depth / rows
    middles = [(row + 0.5) * block for row in range(rows)]
    for middle in middles:
        half = RESOLUTION * int(random.integers(8, 12))
        floor.open(0.5, middle - half, length - 0.5, middle + half)
        for outer, inner in ((middle - 0.5 * block, middle - half), (middle + 0.5 * block, middle + half)):
            _narrow_row(random, floor, outer, inner)
    for left in (0.5, length - 1.4) if rows > 1 else ():
        floor.open(left, middles[0], left + 0.9, middles[-1])
    return floor


def _narrow_row(random: np.random.Generator, floor: Floor, outer: float, inner: float) -> None:
    """Rooms between the outer wall and the corridor, 0.4 m of wall away from either."""
    side = 1.0 if inner > outer else -1.0
    low, high = sorted((outer + side * 0.25, inner - side * 0.4))
    left = 1.8
    while left < floor.length - 4.2:
        right = min(left + random.uniform(2.6, 4.5), floor.length - 1.8)
        floor.open(left, low, right, high)
        door = random.uniform(left + 0.2, right - 0.9)
        floor.open(door, min(inner, inner - side * 0.5), door + 12 * RESOLUTION, max(inner, inner - side * 0.5))
        if random.random() < 0.7:
            niche, wide = random.uniform(low + 0.2, high - 1.0), random.uniform(0.65, 0.8)
            floor.open(right, niche, right + random.uniform(0.4, 0.65), niche + wide)
        left = right + random.uniform(0.8, 1.0)
