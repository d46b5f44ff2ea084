"""Floors of rooms along corridors: blocks of two rows, joined by a cross corridor where there are several."""

import math
from dataclasses import dataclass, replace
from typing import Callable, List, NamedTuple, Tuple

import numpy as np

from .drawing import WALL_M, Floor
from .plan import FloorPlan, Motion

BLOCK_M = 12.5
"""Depth of two rows of rooms and their corridor."""
DOORS_M = 0.9, 1.2
"""Widths of doors."""
_CROSSING_M = 2.2


class Box(NamedTuple):
    """A rectangle, m."""

    left: float
    bottom: float
    right: float
    top: float


@dataclass(frozen=True)
class Room:
    """Width, left end and width of the door, and furniture with `bottom` measured from the outer wall. Metres."""

    width: float
    door: float
    door_width: float
    pieces: Tuple[Box, ...]


NextRoom = Callable[[], Room]


def offices(random: np.random.Generator, length: float) -> FloorPlan:
    """Rooms that differ in width, door and furniture; half as deep as long."""
    return _half_as_deep(random, length, lambda: draw_room(random, random.uniform(2.6, 6.5)))


def furnished_rooms(random: np.random.Generator, length: float) -> FloorPlan:
    """All rooms have the same walls and doors; the furniture differs."""
    first = draw_room(random, random.uniform(3.2, 5.0))
    return _half_as_deep(random, length, lambda: replace(first, pieces=_pieces(random, first.width, first.door)))


def equal_rooms(random: np.random.Generator, length: float) -> FloorPlan:
    """All rooms are exact copies, those on the other side of a corridor mirrored."""
    room = draw_room(random, 0.1 * round(random.uniform(32, 50)))
    plan = _half_as_deep(random, length, lambda: room)
    pitch, count = room.width + WALL_M, int(length / (room.width + WALL_M))
    return replace(plan, aliases=tuple(Motion(number * pitch) for number in range(1, count)))


def clutter(random: np.random.Generator, length: float) -> FloorPlan:
    """Offices with a box of 0.15 m to 0.7 m on every eight square metres."""
    plan = offices(random, length)
    walls, furniture = plan.walls.copy(), np.zeros_like(plan.walls) if plan.furniture is None else plan.furniture.copy()
    for _ in range(int(walls.size * plan.resolution**2 / 8.0)):
        height, width = random.integers(3, 15, 2)
        row, column = int(random.integers(4, walls.shape[0] - 19)), int(random.integers(4, walls.shape[1] - 19))
        window = np.s_[row : row + height, column : column + width]
        if not walls[row - 4 : row + height + 4, column - 4 : column + width + 4].any():
            walls[window] = furniture[window] = True
    return replace(plan, walls=walls, furniture=furniture)


def _half_as_deep(random: np.random.Generator, length: float, next_room: NextRoom) -> FloorPlan:
    count = max(1, round(0.5 * length / BLOCK_M))
    return blocks(random, length, count * BLOCK_M, count, next_room).plan()


def blocks(random: np.random.Generator, length: float, depth: float, count: int, next_room: NextRoom) -> Floor:
    """`count` corridors with a row of rooms on either side, joined by a cross corridor if there are several."""
    floor, block = Floor(length, depth), depth / count
    crossing = random.uniform(0.25, 0.6) * length
    stretches = [(0.0, crossing), (crossing + _CROSSING_M, length)] if count > 1 else [(0.0, length)]
    for number in range(count):
        corridor = random.uniform(1.6, 2.4)
        bottom = number * block
        inner = bottom + 0.5 * (block - corridor)
        for left, right in stretches:
            draw_row(floor, left, right, bottom, inner, next_room)
            draw_row(floor, left, right, bottom + block, bottom + block - (inner - bottom), next_room)
            floor.open(left, inner, right, bottom + block - (inner - bottom))
    if count > 1:
        floor.open(crossing + WALL_M, 0.0, crossing + _CROSSING_M - WALL_M, floor.depth)
    return floor


def draw_row(floor: Floor, left: float, right: float, outer: float, inner: float, next_room: NextRoom) -> None:
    """Rooms from `left` to `right` between the outer wall at `outer` and the corridor at `inner`, which may lie on
    either side. The wall to the corridor is drawn away from it."""
    side = 1.0 if inner > outer else -1.0
    floor.line(left, min(outer, inner), right, min(outer, inner))
    floor.line(left, max(outer, inner) - WALL_M, right, max(outer, inner))
    while left < right - 1.5:
        room = next_room()
        floor.line(left, min(outer, inner), left, max(outer, inner))
        door = left + min(room.door, right - left - room.door_width - 0.2)
        floor.open(door, inner - 2 * WALL_M, door + room.door_width, inner + 2 * WALL_M)
        for piece in room.pieces:
            low, high = sorted((outer + side * piece.bottom, outer + side * piece.top))
            if left + piece.right < right and abs(high - low) < abs(inner - outer):
                floor.furnish(left + piece.left, low, left + piece.right, high)
        left += room.width + WALL_M
    floor.line(right - WALL_M, min(outer, inner), right, max(outer, inner))


def draw_room(random: np.random.Generator, width: float, doors: Tuple[float, float] = DOORS_M) -> Room:
    """A room of that width with furniture and a door whose width (m) lies between the two of `doors`."""
    door_width = random.uniform(*doors)
    door = random.uniform(0.3, width - door_width - 0.3)
    return Room(width, door, door_width, _pieces(random, width, door))


def _pieces(random: np.random.Generator, width: float, door: float) -> Tuple[Box, ...]:
    """Cupboards and desks along the walls, a table and chairs; the way in stays open."""
    boxes: List[Box] = []
    for _ in range(int(random.integers(1, 5))):
        across, deep = random.uniform(0.5, 1.6), random.uniform(0.4, 0.9)
        bottom = random.uniform(0.1, 3.0)
        if random.random() < 0.4:
            left = random.uniform(0.1, width - across)
            boxes.append(Box(left, 0.1, left + across, 0.1 + deep))
        elif random.random() < 0.5:
            boxes.append(Box(WALL_M, bottom, WALL_M + deep, bottom + across))
        else:
            boxes.append(Box(width - deep, bottom, width, bottom + across))
    if width > 3.2 and random.random() < 0.6:
        left, bottom = random.uniform(1.0, width - 2.0), random.uniform(1.2, 2.4)
        boxes.append(Box(left, bottom, left + random.uniform(0.6, 1.2), bottom + random.uniform(0.6, 1.2)))
    for _ in range(int(random.integers(0, 3))):
        left, bottom = random.uniform(0.4, width - 0.8), random.uniform(0.5, 3.2)
        boxes.append(Box(left, bottom, left + 0.45, bottom + 0.45))
    return tuple(box for box in boxes if math.hypot(0.5 * (box.left + box.right) - door - 0.5, 5.0 - box.top) > 1.6)
