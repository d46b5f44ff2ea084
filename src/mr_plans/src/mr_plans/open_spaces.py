"""Floors without rows of rooms: halls, mazes of corridors, rings of corridors, caves."""

from typing import List, Set, Tuple

import numpy as np

from .drawing import RESOLUTION, WALL_M, Floor
from .offices import draw_room, draw_row
from .plan import FloorPlan


def halls(random: np.random.Generator, length: float) -> FloorPlan:
    """Halls of 8 m to 18 m side by side, with a lattice of pillars each, stands, and wide openings between them."""
    return draw_halls(random, length, max(10.0, 0.6 * length)).plan()


def draw_halls(random: np.random.Generator, length: float, depth: float) -> Floor:
    """As `halls`, of that depth (m)."""
    floor = Floor(length, depth)
    left = 0.0
    while left < length - 4.0:
        right = min(length, left + random.uniform(8.0, 18.0))
        if right > length - 4.0:
            right = length
        _pillars(floor, random, left, right)
        floor.line(right - WALL_M, 0.0, right - WALL_M, floor.depth)
        for _ in range(int(floor.depth / 8.0) + 1 if right < length else 0):
            door, width = random.uniform(0.5, floor.depth - 3.0), random.uniform(1.2, 2.5)
            floor.open(right - 2 * WALL_M, door, right + WALL_M, door + width)
        left = right
    return floor


def _pillars(floor: Floor, random: np.random.Generator, left: float, right: float) -> None:
    pitch, size = random.uniform(4.0, 6.5), random.uniform(0.3, 0.6)
    for x in np.arange(left + 0.5 * pitch, right - 1.0, pitch):
        for y in np.arange(0.5 * pitch, floor.depth - 1.0, pitch):
            floor.wall(x, y, x + size, y + size)
    for _ in range(int((right - left) * floor.depth / 25.0)):
        x, y = random.uniform(left + 0.3, right - 2.0), random.uniform(0.3, floor.depth - 2.0)
        floor.furnish(x, y, x + random.uniform(0.4, 2.0), y + random.uniform(0.4, 2.0))


def corridors(random: np.random.Generator, length: float) -> FloorPlan:
    """A maze of corridors with some loops and alcoves; all else is solid."""
    pitch, width = random.uniform(5.0, 7.5), random.uniform(1.6, 2.4)
    columns, rows = max(2, int(length / pitch)), max(2, int(0.6 * length / pitch))
    floor = Floor(columns * pitch, rows * pitch, solid=True)
    draw_maze(floor, random, (columns, rows), (pitch, pitch), width)
    return floor.plan()


def draw_maze(
    floor: Floor, random: np.random.Generator, count: Tuple[int, int], pitch: Tuple[float, float], width: float
) -> None:
    """Corridors of that width (m) between the nodes of a lattice of `count` columns and rows with the given pitches."""
    for (column, row), (next_column, next_row) in _maze(random, *count):
        left, bottom = (min(column, next_column) + 0.5) * pitch[0], (min(row, next_row) + 0.5) * pitch[1]
        right, top = (max(column, next_column) + 0.5) * pitch[0], (max(row, next_row) + 0.5) * pitch[1]
        floor.open(left - 0.5 * width, bottom - 0.5 * width, right + 0.5 * width, top + 0.5 * width)
        if random.random() < 0.6:
            size = random.uniform(0.4, 1.5)
            x, y = random.uniform(left, right), random.uniform(bottom, top)
            floor.open(x - 0.5 * width - 0.3, y - 0.5 * size, x + 0.5 * size, y + 0.5 * width + 0.3)


_Node = Tuple[int, int]


def _maze(random: np.random.Generator, columns: int, rows: int) -> List[Tuple[_Node, _Node]]:
    """Edges of a random spanning tree of a lattice, and a fifth of the others."""
    nodes = [(column, row) for column in range(columns) for row in range(rows)]
    edges = [((x, y), there) for x, y in nodes for there in ((x + 1, y), (x, y + 1)) if there in set(nodes)]
    group = {node: {node} for node in nodes}
    chosen = []
    for number in random.permutation(len(edges)):
        first, second = edges[number]
        if group[first] is not group[second]:
            merged: Set[_Node] = group[first] | group[second]
            group.update({node: merged for node in merged})
        elif random.random() > 0.2:
            continue
        chosen.append((first, second))
    return chosen


def loops(random: np.random.Generator, length: float) -> FloorPlan:
    """Corridors around solid cores with niches, rooms along the outer walls."""
    return draw_loops(random, length, max(18.0, 0.6 * length)).plan()


def draw_loops(random: np.random.Generator, length: float, depth: float) -> Floor:
    """As `loops`, of that depth (m)."""
    floor = Floor(length, depth)
    low, high = 6.8, floor.depth - 6.8
    left = 2.2
    while left < length - 5.0:
        right = left + random.uniform(5.0, 14.0)
        right = length - 2.2 if right > length - 6.0 else right
        floor.wall(left, low, right, high)
        for _ in range(4):
            x, y = random.uniform(left, right), random.uniform(low, high)
            floor.open(x, low, x + random.uniform(0.4, 2.0), low + random.uniform(0.2, 0.8))
            floor.open(left, y, left + random.uniform(0.2, 0.8), y + random.uniform(0.4, 2.0))
        left = right + 2.0
    for outer, inner in ((0.0, 4.8), (floor.depth, floor.depth - 4.8)):
        draw_row(floor, 0.0, length, outer, inner, lambda: draw_room(random, random.uniform(3.0, 6.0)))
    return floor


def caves(random: np.random.Generator, length: float) -> FloorPlan:
    """The largest of the hollows of a smooth random field."""
    import cv2  # here, for who needs no picture: it is slow to import

    coarse = 4
    shape = int(0.7 * length / RESOLUTION) // coarse, int(length / RESOLUTION) // coarse
    smooth = cv2.GaussianBlur(random.normal(0.0, 1.0, shape), (0, 0), 1.1 / (RESOLUTION * coarse))
    smooth[:4], smooth[-4:], smooth[:, :4], smooth[:, -4:] = (smooth.min(),) * 4
    fine = cv2.resize(smooth, (shape[1] * coarse, shape[0] * coarse), interpolation=cv2.INTER_CUBIC)
    hollow = fine > np.quantile(fine, 0.36)
    count, labels = cv2.connectedComponents(hollow.astype(np.uint8))
    largest = 1 + int(np.argmax(np.bincount(labels.ravel(), minlength=count)[1:]))
    return FloorPlan(labels != largest, RESOLUTION)
