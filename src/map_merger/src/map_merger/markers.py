"""What rviz shows of a team: for each robot where it is, its name, and the outline of its local map."""

import colorsys
import zlib
from dataclasses import dataclass
from typing import Optional, Tuple

import numpy as np

from mr_grid import UNKNOWN, OccupancyGrid, Pose
from mr_grid.imaging import largest_contour, simplified

from .grid import cropped, known_box

MOST_OUTLINE_CELLS = 400
"""Larger maps are looked at on a coarser lattice of at most so many cells a side."""
MOST_OUTLINE_POINTS = 200
_TOLERANCE_CELLS = 1.5


@dataclass(frozen=True, eq=False)
class RobotMarker:
    """A robot in the own map frame: its pose if known, and the closed outline (n, 2; m) of its map, maybe empty."""

    robot: str
    pose: Optional[Pose]
    outline: np.ndarray


def marker_of(robot: str, pose: Optional[Pose], outline: np.ndarray, frame: Pose) -> RobotMarker:
    """A robot whose pose and outline are given in its own map frame; `frame`: that frame -> the own one."""
    placed = None if pose is None else frame.compose(pose)
    return RobotMarker(robot, placed, frame.apply(outline) if len(outline) else outline)


def outline_of(grid: OccupancyGrid) -> np.ndarray:
    """Outline of the largest connected known part, (n, 2) in m in the map's frame, at most MOST_OUTLINE_POINTS;
    empty if nothing is known. Not closed: the first point is not repeated."""
    box = known_box(grid)
    if box.empty:
        return np.empty((0, 2))
    part = cropped(grid, box)
    step = max(1, -(-max(part.cells.shape) // MOST_OUTLINE_CELLS))
    known = _coarse(part.cells != UNKNOWN, step)
    contour = largest_contour(known)
    tolerance = _TOLERANCE_CELLS
    outline = simplified(contour, tolerance)
    while len(outline) > MOST_OUTLINE_POINTS:
        tolerance *= 1.5
        outline = simplified(contour, tolerance)
    columns, rows = step * outline.T + 0.5 * (step - 1)
    return part.info.centres(rows, columns)


def colour_of(robot: str) -> Tuple[float, float, float]:
    """Red, green and blue, 0 to 1: always the same for a name, on every robot."""
    return colorsys.hsv_to_rgb(zlib.crc32(robot.encode()) / 2.0**32, 0.8, 0.9)


def _coarse(mask: np.ndarray, step: int) -> np.ndarray:
    """Blocks of step x step cells, true where any cell is."""
    rows, columns = mask.shape
    padded = np.pad(mask, ((0, -rows % step), (0, -columns % step)))
    blocks = padded.reshape(padded.shape[0] // step, step, padded.shape[1] // step, step)
    return blocks.any(axis=(1, 3))
