"""Recent scans: whether a place was in sight, and empty."""

import math
from collections import deque
from typing import Deque, NamedTuple, Tuple

import numpy as np

from mr_grid import Pose

from .values import LaserScan, goes_round

_MOST = 120
_FAR_M = 5.5
_NEAR_M = 0.5
_MARGIN_M = 0.3
_SIDE_M = 0.1
_EDGE_BEAMS = 6
_MOST_OFF = 0.03
"""Of the field of view, by which sweeps of one sensor differ."""


class Seen(NamedTuple):
    """Of places at the times of the sweeps, bool (n,): an obstacle is there; the place and its surroundings are empty.
    Neither where it is hidden or out of sight."""

    there: np.ndarray
    empty: np.ndarray


class Sweeps(NamedTuple):
    """times: float (n,), s. eyes: complex (n,), m, and headings: unit complex (n,), of the sensor in the map frame.
    ranges: float32 (n, beams), m, 0 = invalid. first, step: rad. farthest: m."""

    times: np.ndarray
    eyes: np.ndarray
    headings: np.ndarray
    ranges: np.ndarray
    first: float
    step: float
    farthest: float

    def look(self, places: np.ndarray, known: np.ndarray, reach: float = _FAR_M) -> Seen:
        """places: complex (n,), m, one for each sweep. Not looked at are those that are not `known`, and those farther
        away than `reach` (m)."""
        if not len(self.times):
            return Seen(np.zeros(0, bool), np.zeros(0, bool))
        seen = (places - self.eyes) * self.headings.conjugate()
        distance = np.abs(seen)
        beam, beams = self._beams(np.angle(seen)), self.ranges.shape[1]
        side = _SIDE_M / np.maximum(distance, 0.1) / abs(self.step)
        near, far = _NEAR_M, min(reach, self.farthest - _MARGIN_M)
        inside = known & (distance > near) & (distance < far)
        round_about = goes_round(beams, self.step)
        if not round_about:
            inside &= (beam - side > _EDGE_BEAMS) & (beam + side < beams - 1 - _EDGE_BEAMS)
        there, empty = np.zeros(len(inside), bool), inside.copy()
        rows = np.arange(len(inside))
        for offset in (-side, 0.0, side):
            at = np.rint(beam + offset)
            if round_about:
                at = np.where(at < 0.0, at + beams, np.where(at >= beams, at - beams, at))
            ranges = self.ranges[rows, np.minimum(np.maximum(at, 0.0), beams - 1.0).astype(int)]
            there |= inside & (ranges > 0.0) & (np.abs(ranges - distance) < _MARGIN_M + 0.1)
            empty &= ranges > distance + _MARGIN_M
        return Seen(there, empty)

    def _beams(self, bearings: np.ndarray) -> np.ndarray:
        """Which of the beams go in directions (n,), rad, whether their angles run from -pi or from 0 on."""
        beam = (bearings - self.first) / self.step
        turn = 2.0 * math.pi / abs(self.step)
        within: np.ndarray = beam - turn * np.floor(beam / turn)
        return within


NO_SWEEPS = Sweeps(np.zeros(0), np.zeros(0, complex), np.zeros(0, complex), np.zeros((0, 1), np.float32), 0.0, 1.0, 0.0)


def _geometry_of(scan: LaserScan) -> Tuple[float, float, float, int]:
    return scan.angle_min, scan.angle_increment, scan.range_max, scan.ranges.size


class SweepHistory:
    """The latest scans of one sensor, bounded."""

    def __init__(self) -> None:
        self._kept: Deque[Tuple[float, Pose, np.ndarray]] = deque(maxlen=_MOST)
        self._geometry: Tuple[float, float, float, int] = (0.0, 1.0, 0.0, 0)

    def add(self, now: float, scan: LaserScan, pose: Pose) -> None:
        """Scans of another sensor, or a clock that jumped back, begin the history anew."""
        if not self._is_alike(scan) or (self._kept and now < self._kept[-1][0]):
            self._kept.clear()
            self._geometry = _geometry_of(scan)
        with np.errstate(invalid="ignore"):
            ranges = np.where(scan.ranges >= scan.range_min, scan.ranges, 0.0).astype(np.float32)
        self._kept.append((now, pose.compose(scan.mount), self._resampled(scan, ranges)))

    def _is_alike(self, scan: LaserScan) -> bool:
        """Whether the sensor looks where it looked: some take a beam more or less from one turn to the next."""
        first, step, farthest, beams = self._geometry
        last, scan_last = first + step * beams, scan.angle_min + scan.angle_increment * scan.ranges.size
        off = max(abs(scan.angle_min - first), abs(scan_last - last), abs(scan.ranges.size - beams) * abs(step))
        return scan.range_max == farthest and scan.angle_increment * step > 0.0 and off <= _MOST_OFF * abs(last - first)

    def _resampled(self, scan: LaserScan, ranges: np.ndarray) -> np.ndarray:
        """The beams that are nearest to those of the geometry."""
        first, step, _, beams = self._geometry
        if _geometry_of(scan) == self._geometry:
            return ranges
        at = np.rint((first + step * np.arange(beams) - scan.angle_min) / scan.angle_increment).astype(int)
        there = (at >= 0) & (at < ranges.size)
        return np.where(there, ranges[np.clip(at, 0, ranges.size - 1)], np.float32(0.0))

    def clear(self) -> None:
        """Forgets everything."""
        self._kept.clear()

    def all(self) -> Sweeps:
        """As arrays."""
        first, step, farthest, _ = self._geometry
        if not self._kept:
            return NO_SWEEPS
        times, eyes, ranges = zip(*self._kept)
        return Sweeps(
            np.array(times),
            np.array([complex(eye.x, eye.y) for eye in eyes]),
            np.array([complex(math.cos(eye.yaw), math.sin(eye.yaw)) for eye in eyes]),
            np.stack(ranges),
            first,
            step,
            farthest,
        )
