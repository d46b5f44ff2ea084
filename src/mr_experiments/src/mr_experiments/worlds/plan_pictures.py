"""Pictures of worlds to look at: walls, furniture, where robots start."""

from __future__ import annotations

from typing import Sequence

import cv2
import numpy as np

from mr_plans import FloorPlan, WorldName, parse_name, robot_starts, world_plan
from mr_plans.names import is_generated
from mr_sim.raster import rasterise
from mr_sim.world_model import load_world
from mr_sim.worlds import find_world, radius_for

PIXEL = 0.1  # m
GAP, CAPTION = 12, 26  # pixels
WIDEST = 1250  # pixels of a sheet
WALL, FURNITURE, FLOOR, START, INK = (40, 40, 40), (190, 160, 120), (255, 255, 255), (60, 60, 220), (0, 0, 0)  # BGR


def sheet(names: Sequence[str]) -> np.ndarray:
    """The worlds, each with its name, in rows; uint8 (rows, columns, 3), BGR."""
    rows: list[list[np.ndarray]] = [[]]
    for tile in map(_tile, names):
        if rows[-1] and _width(rows[-1]) + tile.shape[1] > WIDEST:
            rows.append([])
        rows[-1].append(tile)
    height = sum(_height(row) for row in rows) + GAP
    picture = np.full((height, max(map(_width, rows)), 3), FLOOR, dtype=np.uint8)
    top = GAP
    for row in rows:
        left = GAP
        for tile in row:
            picture[top : top + tile.shape[0], left : left + tile.shape[1]] = tile
            left += tile.shape[1] + GAP
        top += _height(row)
    return picture


def _width(row: Sequence[np.ndarray]) -> int:
    return GAP + sum(tile.shape[1] + GAP for tile in row)


def _height(row: Sequence[np.ndarray]) -> int:
    return max(tile.shape[0] for tile in row) + GAP


def _tile(name: str) -> np.ndarray:
    return _generated_tile(parse_name(name)) if is_generated(name) else _stored_tile(name)


def _generated_tile(name: WorldName) -> np.ndarray:
    plan = world_plan(name.kind, name.seed, name.size)
    starts = robot_starts(name, plan, radius_for(name))
    length, depth = name.size
    return _finished(_coloured(plan), [start[:2] for start in starts],
                     f"{name.kind}:{name.seed}  {length:g} m x {depth:g} m")  # fmt: skip


def _stored_tile(name: str) -> np.ndarray:
    world = load_world(find_world(name))
    grid = rasterise(world.obstacles, world.resolution)
    scale = grid.resolution / PIXEL
    rows, columns = (max(1, round(scale * side)) for side in grid.cells.shape)
    share = cv2.resize(grid.cells.astype(np.float32), (columns, rows), interpolation=cv2.INTER_AREA)
    picture = np.full((*share.shape, 3), FLOOR, dtype=np.uint8)
    picture[share > 0.1] = WALL
    starts = [(robot.start[0] - grid.origin[0], robot.start[1] - grid.origin[1]) for robot in world.robots]
    length, depth = (PIXEL * side for side in (columns, rows))
    return _finished(np.ascontiguousarray(np.flipud(picture)), starts, f"{name}  {length:g} m x {depth:g} m")


def _finished(picture: np.ndarray, starts: Sequence[tuple[float, float]], text: str) -> np.ndarray:
    for x, y in starts:
        cv2.circle(picture, (round(x / PIXEL), picture.shape[0] - 1 - round(y / PIXEL)), 3, START, -1)
    (width, _), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, 0.5, 1)
    beside = np.full((picture.shape[0], max(0, width + 4 - picture.shape[1]), 3), FLOOR, dtype=np.uint8)
    picture = np.concatenate([picture, beside], axis=1)
    caption = np.full((CAPTION, picture.shape[1], 3), FLOOR, dtype=np.uint8)
    cv2.putText(caption, text, (2, 18), cv2.FONT_HERSHEY_SIMPLEX, 0.5, INK, 1)
    return np.concatenate([caption, picture])


def _coloured(plan: FloorPlan) -> np.ndarray:
    """North at the top; a pixel is a wall if any cell in it is."""
    block = round(PIXEL / plan.resolution)
    picture = np.full((*(-(-size // block) for size in plan.walls.shape), 3), FLOOR, dtype=np.uint8)
    for mask, colour in ((plan.furniture, FURNITURE), (plan.walls if plan.furniture is None
                         else plan.walls & ~plan.furniture, WALL)):  # fmt: skip
        if mask is not None:
            rows, columns = np.nonzero(mask)
            picture[rows // block, columns // block] = colour
    return np.ascontiguousarray(np.flipud(picture))
