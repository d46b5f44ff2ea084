"""Pictures of generated worlds to look at: walls, furniture, where robots start."""

from __future__ import annotations

from typing import Sequence

import cv2
import numpy as np

from mr_plans import FloorPlan, WorldName, anywhere, side_by_side, world_plan

PIXEL = 0.1  # m
GAP, CAPTION = 12, 26  # pixels
WIDEST = 1250  # pixels of a sheet
WALL, FURNITURE, FLOOR, START, INK = (40, 40, 40), (190, 160, 120), (255, 255, 255), (60, 60, 220), (0, 0, 0)  # BGR


def sheet(names: Sequence[WorldName]) -> np.ndarray:
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


def _tile(name: WorldName) -> np.ndarray:
    plan = world_plan(name.kind, name.seed, name.size)
    picture = _coloured(plan)
    for x, y, _ in (anywhere if name.anywhere else side_by_side)(plan, name.seed):
        cv2.circle(picture, (round(x / PIXEL), picture.shape[0] - 1 - round(y / PIXEL)), 3, START, -1)
    caption = np.full((CAPTION, picture.shape[1], 3), FLOOR, dtype=np.uint8)
    length, depth = name.size
    text = f"{name.kind}:{name.seed}  {length:g} m x {depth:g} m"
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
