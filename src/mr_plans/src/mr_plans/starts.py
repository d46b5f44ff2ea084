"""Where robots start in a plan: side by side, or anywhere."""

import math
from collections import deque
from typing import List, Tuple

import numpy as np

from .passable import places, reachable
from .plan import FloorPlan

MOST_ROBOTS = 16
ABREAST_M, BEHIND_M = 0.12, 0.22
"""Left between robots that start side by side, across and along their heading 0, however they turn."""
APART_M = 2.0, 1.5, 1.0
"""Between the middles of robots that start anywhere: the first of these distances for which the plan has room, or that
of robots side by side."""
_STAND_M = 0.06
"""Left between a robot that turns on the spot and the centre of the nearest wall cell."""
_TRIALS = 60
_STREAM = 0x53544152

Start = Tuple[float, float, float]
"""x, y in m, heading in rad, in the world."""


def side_by_side(plan: FloorPlan, seed: int, radius: float, count: int = MOST_ROBOTS) -> List[Start]:
    """Starts with heading 0 on a lattice, as near together as the free spot allows, so that the first of them are a
    good start for a smaller team. `radius`: m, from the middle of a robot to its farthest corner. ValueError if the
    plan has no room for `count` robots."""
    standing = _standing(plan, radius)
    steps = round(_step(radius, ABREAST_M) / plan.resolution), round(_step(radius, BEHIND_M) / plan.resolution)
    spots = np.argwhere(standing)
    random = np.random.Generator(np.random.PCG64([_STREAM, seed]))
    best: List[Tuple[int, int]] = []
    reach = math.inf
    for number in random.integers(0, max(1, len(spots)), _TRIALS).tolist() if len(spots) else ():
        row, column = spots[number].tolist()
        group, farthest = _group(standing, (row, column), steps, count)
        if len(group) == count and farthest < reach:
            best, reach = group, farthest
    if not best:
        raise ValueError(f"no free spot of this plan holds {count} robots side by side")
    return [_pose(plan, row, column, 0.0) for row, column in best]


def anywhere(plan: FloorPlan, seed: int, radius: float, count: int = MOST_ROBOTS) -> List[Start]:
    """Starts all over the plan, in any heading (rad, a whole number of degrees), 2 m apart or as far as there is room.
    `radius`: m, from the middle of a robot to its farthest corner. ValueError if the plan has no room for `count`
    robots."""
    spots = np.argwhere(_standing(plan, radius))
    nearest = _step(radius, ABREAST_M)
    for apart in (*APART_M, nearest):
        random = np.random.Generator(np.random.PCG64([_STREAM, 1, seed]))
        chosen = _scattered(random, spots, apart / plan.resolution, count)
        if len(chosen) == count:
            return [_pose(plan, row, column, math.radians(int(random.integers(-179, 181)))) for row, column in chosen]
    raise ValueError(f"this plan has no room for {count} robots {nearest:g} m apart")


def _scattered(random: np.random.Generator, spots: np.ndarray, apart: float, count: int) -> List[Tuple[int, int]]:
    """At most `count` of the spots (n, 2; cells), no two nearer to one another than `apart` cells."""
    chosen: List[Tuple[int, int]] = []
    while len(chosen) < count and len(spots):
        row, column = spots[int(random.integers(0, len(spots)))].tolist()
        chosen.append((row, column))
        spots = spots[((spots - (row, column)) ** 2).sum(axis=1) >= apart**2]
    return chosen


def _step(radius: float, left: float) -> float:
    """m from the middle of a robot to that of the next one."""
    return round(2.0 * radius + left, 3)


def _standing(plan: FloorPlan, radius: float) -> np.ndarray:
    cells = round((radius + _STAND_M) / plan.resolution)
    standing: np.ndarray = reachable(plan.walls) & places(plan.walls, cells)
    return standing


def _group(
    standing: np.ndarray, first: Tuple[int, int], steps: Tuple[int, int], count: int
) -> Tuple[List[Tuple[int, int]], int]:
    """Sites of the lattice through `first`, step by step over neighbours that have standing room all the way between
    them, until there are `count`; and the number of steps to the last one."""
    group: List[Tuple[int, int]] = []
    waiting, seen, farthest = deque([(first, 0)]), {first}, 0
    while waiting and len(group) < count:
        (row, column), farthest = waiting.popleft()
        group.append((row, column))
        for down, right in ((0, steps[1]), (-steps[0], 0), (0, -steps[1]), (steps[0], 0)):
            there = row + down, column + right
            if there not in seen and _clear(standing, (row, column), there):
                seen.add(there)
                waiting.append((there, farthest + 1))
    return group, farthest


def _clear(standing: np.ndarray, here: Tuple[int, int], there: Tuple[int, int]) -> bool:
    (top, bottom), (left, right) = sorted((here[0], there[0])), sorted((here[1], there[1]))
    if top < 0 or left < 0 or bottom >= standing.shape[0] or right >= standing.shape[1]:
        return False
    return bool(standing[top : bottom + 1, left : right + 1].all())


def _pose(plan: FloorPlan, row: int, column: int, heading: float) -> Start:
    return (
        round((column + 0.5) * plan.resolution, 3),
        round((row + 0.5) * plan.resolution, 3),
        heading,
    )
