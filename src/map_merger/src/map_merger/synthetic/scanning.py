"""Laser scans: what a robot measures in a floor plan, and the occupancy grid that scans add up to."""

import math
from dataclasses import dataclass
from typing import Sequence, Tuple

import numpy as np

from mr_grid import FREE, OCCUPIED, UNKNOWN, GridInfo, OccupancyGrid, Pose

_CAST_AT_ONCE = 64
"""Steps along all beams at once; most beams end long before their reach."""


@dataclass(frozen=True)
class Survey:
    """How a robot maps. Lengths in metres, angles in radians."""

    beams: int = 361
    view: float = math.radians(270.0)
    reach: float = 8.0
    range_noise: float = 0.01
    step: float = 0.4
    path_length: float = 12.0
    drift: float = 0.0
    """Standard deviation to which the pose error wanders over the whole path (m; a fifth of it per metre as rad)."""
    smudges: int = 0
    """Scans that see another robot in the way."""
    resolution: float = 0.05
    stages: Tuple[float, ...] = (1.0,)
    """Shares of the path after which the map is kept."""

    def angles(self) -> np.ndarray:
        """Directions of the beams, (beams,), rad from the robot's heading."""
        return np.linspace(-self.view / 2, self.view / 2, self.beams)


def cast(walls: np.ndarray, resolution: float, pose: Sequence[float], survey: Survey) -> np.ndarray:
    """Ranges in metres of the survey's beams from `pose` (x, y, yaw); the reach where nothing is hit."""
    angles = pose[2] + survey.angles()
    directions = np.stack([np.cos(angles), np.sin(angles)])[..., None]
    distances = np.arange(0.0, survey.reach, 0.4 * resolution)
    ranges = np.full(len(angles), survey.reach)
    under_way = np.arange(len(angles))
    for first in range(0, len(distances), _CAST_AT_ONCE):
        part = distances[first : first + _CAST_AT_ONCE]
        columns, rows = (
            _clipped((start + part * along[under_way]) / resolution, size)
            for start, along, size in zip(pose, directions, walls.shape[::-1])
        )
        blocked = walls[rows, columns]
        nearest = blocked.argmax(axis=1)
        hit = blocked[np.arange(len(nearest)), nearest]
        ranges[under_way[hit]] = part[nearest[hit]]
        under_way = under_way[~hit]
        if not len(under_way):
            break
    return ranges


def _clipped(cells: np.ndarray, size: int) -> np.ndarray:
    # np.clip costs more than the look-up.
    whole = cells.astype(np.int32)
    np.maximum(whole, 0, out=whole)
    return np.minimum(whole, size - 1, out=whole)


class GridDrawer:
    """Adds scans up to a grid: how often each cell was hit, and how often a beam passed it."""

    def __init__(self, info: GridInfo) -> None:
        self._info = info
        self._hits = np.zeros(info.shape, np.int32)
        self._passes = np.zeros(info.shape, np.int32)

    def add(self, pose: Pose, angles: np.ndarray, ranges: np.ndarray, reach: float) -> None:
        """One scan from `pose` (the laser in the grid's frame); a range (m) of at least `reach` hit nothing. All must
        lie inside the grid."""
        info = self._info
        angles = pose.yaw + angles
        distances = np.arange(0.0, reach, 0.7 * info.resolution)
        x, y = pose.x - info.origin.x, pose.y - info.origin.y
        passing = self._cells(x, y, distances, angles[:, None])
        passed = np.zeros(info.width * info.height, bool)
        passed[passing[distances < ranges[:, None] - 0.5 * info.resolution]] = True
        hit = ranges < reach
        ends = np.unique(self._cells(x, y, ranges[hit], angles[hit]))
        passed[ends] = False
        self._passes.ravel()[passed] += 1
        self._hits.ravel()[ends] += 1

    def _cells(self, x: float, y: float, distances: np.ndarray, angles: np.ndarray) -> np.ndarray:
        columns = np.floor((x + distances * np.cos(angles)) / self._info.resolution)
        rows = np.floor((y + distances * np.sin(angles)) / self._info.resolution)
        return (rows * self._info.width + columns).astype(np.int64)

    def grid(self) -> OccupancyGrid:
        """The grid so far."""
        cells = np.full(self._info.shape, UNKNOWN, np.int8)
        cells[self._passes > 0] = FREE
        cells[(self._hits > 0) & (3 * self._hits >= self._passes)] = OCCUPIED
        return OccupancyGrid(self._info, cells)


def info_around(path: np.ndarray, reach: float, resolution: float, shift: Sequence[float] = (0.0, 0.0)) -> GridInfo:
    """A grid that holds all scans of that reach (m) from `path` (n, 2; m); `shift` (m) moves its lattice."""
    margin = reach + 1.0
    low = np.floor((path.min(axis=0) - margin) / resolution) * resolution + np.asarray(shift)
    columns, rows = np.ceil((path.max(axis=0) + margin - low) / resolution).astype(int)
    return GridInfo(int(columns), int(rows), resolution, Pose(float(low[0]), float(low[1]), 0.0))
