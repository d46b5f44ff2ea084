"""Floors of 24.6 m x 12.2 m: two rows of rooms along a corridor, with exact copies where a test wants them."""

import math
from typing import NamedTuple, Optional, Sequence

import numpy as np

from .plan import FloorPlan, Motion


class Room(NamedTuple):
    """Furniture (bool, row 0 at the outer wall of the south side) and the column at which the door begins."""

    furniture: np.ndarray
    door: int

    def turned(self) -> "Room":
        """The room as it is on the other side of the corridor of a building that is turned by 180 degrees."""
        return Room(self.furniture[::-1, ::-1], _PITCH - self.door - _DOOR + 1)


_PITCH, _DEPTH, _CORRIDOR, _DOOR = 82, 98, 46, 20
"""Cells of 0.05 m: room to room, outer wall to corridor wall, width of the corridor, of a door."""


def office_plan(random: np.random.Generator, rooms: int = 6, same: bool = False) -> FloorPlan:
    """Two rows of rooms of 4.1 m x 4.9 m along a corridor; with `same` all rooms of a row are exact copies."""
    rows = []
    for _ in range(2):
        room = _room(random)
        rows.append([room if same else _room(random) for _ in range(rooms)])
    return _assembled(rows, [_shifted(distance) for distance in range(1, rooms)] if same else [])


def turned_copies_plan(random: np.random.Generator, rooms: int = 6) -> FloorPlan:
    """All rooms are copies of one; on the north side of the corridor they are turned by 180 degrees."""
    room = _room(random)
    copies = [_shifted(distance) for distance in range(1, rooms)]
    turns = [_turned((rooms + distance) * _PITCH) for distance in range(1 - rooms, rooms)]
    return _assembled([[room] * rooms, [room.turned()] * rooms], copies + turns, even=True)


def bare_rooms_plan(random: np.random.Generator, rooms: int = 6) -> FloorPlan:
    """Equal rooms without furniture, doors opposite one another: turned by 180 degrees the corridor is the same."""
    room = Room(np.zeros((_DEPTH - 2, _PITCH - 1), bool), (_PITCH - _DOOR) // 2)
    copies = [_shifted(distance) for distance in range(1, rooms)]
    turns = [_turned((rooms + distance) * _PITCH) for distance in range(1 - rooms, rooms)]
    return _assembled([[room] * rooms, [room.turned()] * rooms], copies + turns, even=True)


def symmetric_plan(random: np.random.Generator, rooms: int = 6) -> FloorPlan:
    """All rooms of the south side differ; the whole building is the same when turned by 180 degrees."""
    south = [_room(random) for _ in range(rooms)]
    return _assembled([south, [room.turned() for room in reversed(south)]], [_turned(rooms * _PITCH)], even=True)


def long_corridor_plan(random: np.random.Generator, rooms: int = 7) -> FloorPlan:
    """A corridor of 28 m without doors but at its ends, where copies of one pair of rooms are."""
    ends = [_room(random), _room(random)]
    rows = [[end] + [None] * (rooms - 2) + [end] for end in ends]
    return _assembled(rows, [_shifted(rooms - 1)])


def _assembled(rows: Sequence[Sequence[Optional[Room]]], aliases: Sequence[Motion], even: bool = False) -> FloorPlan:
    """South and north row of rooms along a corridor; None is solid. `even`: the north row is as deep as the south row
    to the cell."""
    width, height = len(rows[0]) * _PITCH + 1, 2 * _DEPTH + _CORRIDOR + 2
    walls = np.zeros((height, width), bool)
    walls[[0, -1]] = True
    walls[:, [0, -1]] = True
    north = _DEPTH + _CORRIDOR + even
    for row, inner, outer, bottom in (
        (rows[0], _DEPTH, slice(0, _DEPTH), 1),
        (rows[1], north, slice(north, height), north + 1 + even),
    ):
        walls[inner] = True
        for number, room in enumerate(row):
            left = number * _PITCH
            if room is None:
                walls[outer, left : left + _PITCH] = True
                continue
            walls[outer, left] = True
            walls[bottom : bottom + _DEPTH - 2, left + 1 : left + _PITCH] |= room.furniture
            walls[inner, left + room.door : left + room.door + _DOOR] = False
    return FloorPlan(walls, aliases=tuple(aliases))


def _shifted(rooms: int) -> Motion:
    return Motion(rooms * _PITCH * 0.05, 0.0, 0.0)


def _turned(length: int) -> Motion:
    """The turn by 180 degrees that lays the west wall at the column `length`."""
    return Motion((length + 1) * 0.05, (2 * _DEPTH + _CORRIDOR + 2) * 0.05, math.pi)


def _room(random: np.random.Generator) -> Room:
    return Room(_furniture(random, _DEPTH - 2, _PITCH - 1), int(random.integers(8, _PITCH - 30)))


def _furniture(random: np.random.Generator, rows: int, columns: int) -> np.ndarray:
    mask = np.zeros((rows, columns), bool)
    for _ in range(int(random.integers(1, 4))):
        height, width = random.integers(8, 26, 2)
        top, left = int(random.integers(0, rows - height)), int(random.integers(0, columns - width))
        if top > 24 and top + height < rows - 24:
            mask[top : top + height, left : left + width] = True
        elif random.random() < 0.5:
            mask[top : top + height, : width // 2] = True
    return mask
