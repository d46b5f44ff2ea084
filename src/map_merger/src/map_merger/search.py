"""Global search: coarse transforms between two maps, over all rotations and shifts, by correlation.

Walls of one map should fall on walls of the other (reward) and not into its free space (penalty), both ways. For one
rotation all shifts are scored at once with a Fourier transform. The spectrum of wall directions (as in Carpin, "Fast
and accurate map merging for multi-robot systems", 2008) tells which rotations are worth a transform.
"""

import math
from typing import List, NamedTuple, Optional

import numpy as np

from mr_grid import Pose, normalized
from mr_grid.imaging import blurred, box_means, dilated

from ._surfaces import raster
from .surface import Landmarks
from .transform import rotation_between

ROTATION_STEP = math.radians(2.0)
COARSE_CELL = 0.2
"""Metres per cell of the search."""
MOST_COARSE_CELLS = 260
"""Larger maps are searched on a coarser lattice, so that the effort stays bounded."""
_PENALTY = 0.6
_PEAKS_PER_ROTATION = 6


class Candidate(NamedTuple):
    """A coarse transform source -> target and its score (coarse cells of agreeing wall minus penalties)."""

    transform: Pose
    score: float


class Prior(NamedTuple):
    """A rough transform source -> target that somebody gave, and how far (m, rad) the truth may be from it."""

    transform: Pose
    distance: float = 3.0
    rotation: float = math.radians(30.0)


def candidates(target: Landmarks, source: Landmarks, most: int, prior: Optional[Prior] = None) -> List[Candidate]:
    """The `most` best coarse transforms that map the source's points into the target's frame, best first, all
    different.

    With a prior only transforms within its bounds, the distance taken at the middle of the source's walls.
    """
    if not len(target.surface.points) or not len(source.surface.points):
        return []
    centre = source.surface.points.mean(axis=0)
    found: List[Candidate] = []
    rotations = _rotations(target, source, prior)
    if not rotations:
        return []
    scorer = _ShiftScorer(target, source, centre, prior)
    for rotation in rotations:
        found.extend(scorer.peaks(rotation))
    found.sort(key=lambda candidate: -candidate.score)
    return _distinct(found, centre, most)


def _rotations(target: Landmarks, source: Landmarks, prior: Optional[Prior]) -> List[float]:
    """Rotations at which the wall directions of both maps agree fairly well, at least the better third of all."""
    bins = round(2.0 * math.pi / ROTATION_STEP)
    first, second = (_direction_histogram(part.surface.normals, bins) for part in (target, source))
    spectrum = np.fft.irfft(np.fft.rfft(first) * np.conj(np.fft.rfft(second)), bins)
    peak = spectrum.max()
    chosen = [normalized(index * ROTATION_STEP) for index in range(bins) if spectrum[index] >= 0.4 * peak]
    if prior is None:
        return chosen
    everywhere = [normalized(index * ROTATION_STEP) for index in range(bins)]
    return [angle for angle in everywhere if abs(normalized(angle - prior.transform.yaw)) <= prior.rotation]


def _direction_histogram(normals: np.ndarray, bins: int) -> np.ndarray:
    angles = np.arctan2(normals[:, 1], normals[:, 0])
    histogram = np.bincount(np.rint(angles / (2.0 * math.pi) * bins).astype(int) % bins, minlength=bins).astype(float)
    offsets = np.minimum(np.arange(bins), bins - np.arange(bins)) * (2.0 * math.pi / bins)
    kernel = np.exp(-0.5 * (offsets / math.radians(3.0)) ** 2)
    return np.fft.irfft(np.fft.rfft(histogram) * np.fft.rfft(kernel), bins)


class _ShiftScorer:
    """Scores all shifts of the source for one rotation after the other."""

    def __init__(self, target: Landmarks, source: Landmarks, centre: np.ndarray, prior: Optional[Prior]) -> None:
        from . import fourier  # slow to import

        self._fourier = fourier
        self._centre = centre
        extent = max(_extent(target), _extent(source))
        self._cell = max(COARSE_CELL, target.info.resolution, extent / MOST_COARSE_CELLS)
        self._walls = source.surface.points - centre
        self._clear = _thinned_points(source, self._cell) - centre
        self._clear_weight = (source.info.resolution / self._cell) ** 2 * _stride(source, self._cell) ** 2
        reach = float(np.hypot(*np.vstack([self._walls, self._clear]).T).max())
        self._half = math.ceil(reach / self._cell) + 1
        self._low = target.surface.points.min(axis=0)
        columns, rows = np.ceil((target.surface.points.max(axis=0) - self._low) / self._cell).astype(int) + 1
        clear_points = _thinned_points(target, self._cell)
        if len(clear_points):
            self._low = np.minimum(self._low, clear_points.min(axis=0))
            high = np.maximum(target.surface.points.max(axis=0), clear_points.max(axis=0))
            columns, rows = np.ceil((high - self._low) / self._cell).astype(int) + 1
        side = 2 * self._half + 1
        self._shape = tuple(fourier.next_fast_len(int(cells) + side) for cells in (rows, columns))
        walls = self._raster(target.surface.points, Pose(), self._low, target.surface.spacing / self._cell)
        clear_weight = (target.info.resolution / self._cell) ** 2 * _stride(target, self._cell) ** 2
        clear = self._raster(clear_points, Pose(), self._low, clear_weight)
        field = np.minimum(blurred(np.minimum(walls, 2.0), 1.0) * 2.0, 1.0)
        field -= _PENALTY * np.minimum(clear, 1.0) * (field < 0.1)
        self._field = fourier.rfft2(field)
        self._wall_spectrum = fourier.rfft2(np.minimum(walls, 2.0))
        self._wall_weight = source.surface.spacing / self._cell
        self._allowed = None if prior is None else self._near(prior)

    def peaks(self, rotation: float) -> List[Candidate]:
        """The best shifts for the rotation."""
        turn = Pose(0.0, 0.0, rotation)
        corner = np.full(2, -(self._half + 0.5) * self._cell)
        walls = self._raster(self._walls, turn, corner, self._wall_weight)
        clear = self._raster(self._clear, turn, corner, self._clear_weight)
        near_walls = box_means(walls, 3) > 0.0
        clear = np.where(near_walls, 0.0, np.minimum(clear, 1.0)).astype(np.float32)
        spectra = self._fourier.rfft2(np.stack([walls, clear]))
        score = self._fourier.irfft2(
            self._field * np.conj(spectra[0]) - _PENALTY * self._wall_spectrum * np.conj(spectra[1]), self._shape
        )
        return self._best(np.ascontiguousarray(score, dtype=np.float32), rotation)

    def _best(self, score: np.ndarray, rotation: float) -> List[Candidate]:
        if self._allowed is not None:
            score = np.where(self._allowed, score, np.float32(-1e9))
        top = dilated(score, 5)
        threshold = max(1.0, 0.3 * float(score.max()))
        rows, columns = np.nonzero((score == top) & (score >= threshold))
        order = np.argsort(-score[rows, columns], kind="stable")[:_PEAKS_PER_ROTATION]
        rows, columns = rows[order], columns[order]
        shifts = self._place(rows, columns) - Pose(0.0, 0.0, rotation).apply(self._centre[None])
        return [
            Candidate(Pose(x, y, rotation), value)
            for (x, y), value in zip(shifts.tolist(), score[rows, columns].tolist())
        ]

    def _place(self, row: np.ndarray, column: np.ndarray) -> np.ndarray:
        """Where the middle of the source's walls comes to lie for a shift found in the correlation."""
        row = np.where(row > self._shape[0] - 2 * self._half - 2, row - self._shape[0], row)
        column = np.where(column > self._shape[1] - 2 * self._half - 2, column - self._shape[1], column)
        return np.stack([column + self._half + 0.5, row + self._half + 0.5], axis=-1) * self._cell + self._low

    def _near(self, prior: Prior) -> np.ndarray:
        """The shifts, bool (rows, columns), that lay the middle of the source's walls near its place in the prior."""
        rows, columns = np.mgrid[0 : self._shape[0], 0 : self._shape[1]]
        wanted = prior.transform.apply(self._centre[None])[0]
        return np.hypot(*np.moveaxis(self._place(rows, columns) - wanted, -1, 0)) <= prior.distance

    def _raster(self, points: np.ndarray, transform: Pose, corner: np.ndarray, weight: float) -> np.ndarray:
        """`weight` for each transformed point in its cell; cell (0, 0) has its corner at `corner`."""
        return raster(points, transform, tuple(corner), self._cell, self._shape, weight)


def _stride(part: Landmarks, cell: float) -> int:
    return max(1, int(0.5 * cell / part.info.resolution))


def _thinned_points(part: Landmarks, cell: float) -> np.ndarray:
    """Centres of well observed free cells, about four per coarse cell."""
    stride = _stride(part, cell)
    rows, columns = np.nonzero(part.clear[::stride, ::stride])
    return part.info.centres(rows * stride, columns * stride)


def _extent(part: Landmarks) -> float:
    return max(part.info.shape) * part.info.resolution


def _distinct(found: List[Candidate], centre: np.ndarray, most: int) -> List[Candidate]:
    result: List[Candidate] = []
    for candidate in found:
        place = candidate.transform.apply(centre[None])[0]
        if all(
            rotation_between(candidate.transform, other.transform) > math.radians(5.0)
            or np.hypot(*(other.transform.apply(centre[None])[0] - place)) > 0.5
            for other in result
        ):
            result.append(candidate)
            if len(result) == most:
                break
    return result


def same_place(first: Pose, second: Pose, points: np.ndarray, distance: float = 0.5) -> bool:
    """True if both transforms put the points (n, 2) within `distance` metres of each other on average."""
    moved = first.apply(points) - second.apply(points)
    return bool(np.hypot(moved[:, 0], moved[:, 1]).mean() <= distance)
