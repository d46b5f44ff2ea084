"""What became of one pair: right, imprecise, wrong or declined.

Wrong: accepted, and off by more than 0.25 m anywhere in the overlap or 2 deg. Right: accepted, and the mean
displacement over the overlap is at most 0.1 m. Imprecise: between. Overlap: the source's known cells that the target
knows at the true transform. Truth under distortion: the best rigid fit, which is the true transform refined on the
shared walls.
"""

import math
from typing import Dict, Iterable, NamedTuple, Optional

import cv2
import numpy as np

from mr_grid import OccupancyGrid, Pose, values_at

from ..evidence import compare
from ..grid import cropped, known_box, occupied_cells
from ..refine import FINE_REACH, refined
from ..surface import Landmarks
from ..transform import displacement, rotation_between

RIGHT_M = 0.1
WRONG_M = 0.25
WRONG_RAD = math.radians(2.0)
KINDS = ("right", "imprecise", "wrong", "declined")


class Outcome(NamedTuple):
    """One answer to one pair. Errors in m and rad, infinite if declined; `seconds` is the CPU time it took."""

    kind: str
    reason: str
    mean_error: float = math.inf
    largest_error: float = math.inf
    rotation_error: float = math.inf
    seconds: float = 0.0


def outcome_of(transform: Optional[Pose], truth: Pose, points: np.ndarray, reason: str, seconds: float) -> Outcome:
    """The outcome of an answer (None = declined) against the truth, over the overlap `points` (n, 2; m)."""
    if transform is None:
        return Outcome("declined", reason, seconds=seconds)
    error, rotation = displacement(truth, transform, points), rotation_between(truth, transform)
    return Outcome(classify(error, rotation), reason, float(error.mean()), float(error.max()), rotation, seconds)


def classify(error: np.ndarray, rotation: float) -> str:
    """Kind of an accepted transform from its displacement (m) over the overlap and its rotation error (rad)."""
    if error.max() > WRONG_M or rotation > WRONG_RAD:
        return "wrong"
    return "right" if error.mean() <= RIGHT_M else "imprecise"


def best_rigid_fit(target: Landmarks, source: Landmarks, truth: Pose) -> Pose:
    """The truth for distorted maps: refined on the shared walls, but never led away by more than a little."""
    fitted = refined(target.surface, source.surface, truth, FINE_REACH)
    moved = displacement(truth, fitted, source.surface.points).max() if len(source.surface.points) else 0.0
    return fitted if moved < 0.3 and compare(target, source, truth).matched > 3.0 else truth


def overlap(target: OccupancyGrid, source: OccupancyGrid, truth: Pose) -> np.ndarray:
    """Points (n, 2) of the source that both maps know; all known ones if there are none."""
    rows, columns = np.nonzero(source.cells[::3, ::3] >= 0)
    points = source.info.centres(3 * rows, 3 * columns)
    shared = values_at(target.cells, target.info, truth.apply(points), -1) >= 0
    return points[shared] if shared.any() else points


def shared_wall(target: OccupancyGrid, source: OccupancyGrid, truth: Pose) -> float:
    """Length in metres of the source's thinned obstacles that lie within one cell of the target's."""
    part = cropped(source, known_box(source).grown(1))
    points = part.info.centres(*np.nonzero(thinned(occupied_cells(part))))
    near = cv2.dilate(occupied_cells(target).view(np.uint8), np.ones((3, 3), np.uint8))
    return float(values_at(near, target.info, truth.apply(points), 0).sum()) * source.info.resolution


def thinned(mask: np.ndarray) -> np.ndarray:
    """Lines one cell wide, bool, in the middle of what is set in `mask` (Zhang and Suen 1984)."""
    cells = np.pad(mask, 1).astype(np.uint8)
    while True:
        before = cells.copy()
        for first in (True, False):
            cells[_removable(cells, first)] = 0
        if np.array_equal(cells, before):
            return cells[1:-1, 1:-1].astype(bool)


def _removable(cells: np.ndarray, first: bool) -> np.ndarray:
    ring = [np.roll(cells, shift, (0, 1)) for shift in _RING]
    count = sum(ring)
    steps = sum((one == 0) & (other == 1) for one, other in zip(ring, ring[1:] + ring[:1]))
    north, east, south, west = ring[0], ring[2], ring[4], ring[6]
    sides = (north & east & south, east & south & west) if first else (north & east & west, north & south & west)
    return (cells == 1) & (count >= 2) & (count <= 6) & (steps == 1) & (sides[0] == 0) & (sides[1] == 0)


_RING = ((1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1))


def counts(outcomes: Iterable[Outcome]) -> Dict[str, int]:
    """How many outcomes of each kind."""
    kinds = [outcome.kind for outcome in outcomes]
    return {kind: kinds.count(kind) for kind in KINDS}
