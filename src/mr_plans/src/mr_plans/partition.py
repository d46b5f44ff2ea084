"""Irregular rooms: a floor divided again and again by walls with doors."""

from typing import List, Tuple

import numpy as np

from .drawing import RESOLUTION, WALL_M, Floor
from .offices import Box

_SMALLEST_M, _LARGEST_M = 2.4, 7.5
"""Sides of rooms."""
_FREE_M = 1.0
"""What stays free of furniture on either side of a door, and of walls for half of that."""
_FURNITURE_AREA = 5.0
"""m2 of a room for each piece of furniture."""


def irregular_rooms(random: np.random.Generator, length: float, depth: float) -> Floor:
    """Rooms of many sizes behind one another, with a door of 0.8 m to 1.0 m in every wall that divided the floor and
    a second one in half of the long ones."""
    floor = Floor(length, depth)
    rooms, walls = _divided(random, floor, Box(0.0, 0.0, length, depth))
    doors = []
    for wall in walls:
        doors += _door(random, floor, wall)
        if max(wall.right - wall.left, wall.top - wall.bottom) > _LARGEST_M and random.random() < 0.5:
            doors += _door(random, floor, wall)
    for room in rooms:
        _furnish(random, floor, room, doors)
    return floor


def _divided(random: np.random.Generator, floor: Floor, area: Box) -> Tuple[List[Box], List[Box]]:
    """Rooms and dividing walls; the walls are drawn."""
    width, height = area.right - area.left, area.top - area.bottom
    long, short = max(width, height), min(width, height)
    if long < 2.0 * _SMALLEST_M or (long < _LARGEST_M and short < 0.8 * _LARGEST_M and random.random() < 0.5):
        return [area], []
    share = random.uniform(max(0.3, _SMALLEST_M / long), min(0.7, 1.0 - _SMALLEST_M / long))
    if width >= height:
        at = area.left + share * width
        wall = Box(at, area.bottom, at + WALL_M, area.top)
        parts = area._replace(right=at), area._replace(left=at + WALL_M)
    else:
        at = area.bottom + share * height
        wall = Box(area.left, at, area.right, at + WALL_M)
        parts = area._replace(top=at), area._replace(bottom=at + WALL_M)
    floor.wall(*wall)
    rooms, walls = [], [wall]
    for part in parts:
        inside, between = _divided(random, floor, part)
        rooms += inside
        walls += between
    return rooms, walls


def _door(random: np.random.Generator, floor: Floor, wall: Box) -> List[Box]:
    """A door where no other wall ends: what is to stay free of furniture. By chance, or else at the first such place
    from the end of the wall; none if there is no such place."""
    width = RESOLUTION * int(random.integers(16, 21))
    upright = wall.top - wall.bottom > wall.right - wall.left
    begin, end = (wall.bottom, wall.top) if upright else (wall.left, wall.right)
    begin, end = begin + 0.15, end - 0.15 - width
    tried = [*(random.uniform(begin, max(begin, end)) for _ in range(20)), *np.arange(begin, end, RESOLUTION)]
    for at in tried:
        door = Box(wall.left, at, wall.right, at + width) if upright else Box(at, wall.bottom, at + width, wall.top)
        if not any(floor.has_wall(*side) for side in _sides(door, upright, 0.5 * _FREE_M)):
            floor.open(*door)
            return _sides(door, upright, _FREE_M)
    return []


def _sides(door: Box, upright: bool, deep: float) -> List[Box]:
    """What lies before and behind a door, `deep` m of it."""
    if upright:
        reach = ((door.left - deep, door.left), (door.right, door.right + deep))
        return [door._replace(left=left, right=right) for left, right in reach]
    reach = ((door.bottom - deep, door.bottom), (door.top, door.top + deep))
    return [door._replace(bottom=bottom, top=top) for bottom, top in reach]


def _furnish(random: np.random.Generator, floor: Floor, room: Box, doors: List[Box]) -> None:
    """Desks and cupboards along the walls, now and then a table in the middle; not before `doors`."""
    width, height = room.right - room.left, room.top - room.bottom
    for _ in range(int(random.integers(0, 2 + int(width * height / _FURNITURE_AREA)))):
        along, deep = random.uniform(0.5, 1.6), random.uniform(0.4, 0.8)
        side = int(random.integers(0, 5))
        across, up = (along, deep) if side % 2 == 0 else (deep, along)
        if across > width - 1.6 or up > height - 1.6:
            continue
        x = room.left + random.uniform(0.0, width - across)
        y = room.bottom + random.uniform(0.0, height - up)
        if side == 4 and width > across + 2.4 and height > up + 2.4:
            x, y = room.left + 0.5 * (width - across), room.bottom + 0.5 * (height - up)
        elif side % 2:
            x = room.left if side == 1 else room.right - across
        else:
            y = room.bottom if side == 0 else room.top - up
        piece = Box(x, y, x + across, y + up)
        if not any(_overlap(piece, door) for door in doors):
            floor.furnish(*piece)


def _overlap(first: Box, second: Box) -> bool:
    return (
        first.left < second.right and second.left < first.right
        and first.bottom < second.top and second.bottom < first.top
    )  # fmt: skip
