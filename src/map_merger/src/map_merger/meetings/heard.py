"""What one other robot told, brought to the own clock."""

import math
from collections import OrderedDict, deque
from typing import Deque, Tuple

import numpy as np

from ..messages import NO_BOOT, Boot
from .tracking import HISTORY_S, Fragment, Trail, moves
from .values import NO_SENSOR, TrackReport

_SPACING_S = 0.02
_MOST_OBJECTS = 24
_LIVELY_S = 3.0
_LIVELY_M = 0.15
_DELAYS = 60
_DELAY_SPAN_S = 60.0
_SET_BACK_S = 20.0
"""A robot whose reports go back so far has set its clock back; less is a late report."""
_FORMER_RUNS = 8
"""So many are known to be over."""


class Heard:
    """The track of another robot, and those of the objects that it sees, in its frame and on its clock.

    A report arrives some time after it was sent. The least difference between arrival and uptime, of the last minute,
    is that of the fastest report, and the best guess of the difference between both clocks.
    """

    def __init__(self) -> None:
        self.boot = NO_BOOT
        self.sensor = NO_SENSOR
        self.unplaced: Tuple[str, ...] = ()
        self._poses = Trail(4, _SPACING_S)
        self._objects: OrderedDict[int, Trail] = OrderedDict()
        self._differences: Deque[Tuple[float, float]] = deque(maxlen=_DELAYS)
        self._newest = -math.inf
        self._former: Deque[Boot] = deque(maxlen=_FORMER_RUNS)
        self.heard_at = -math.inf

    def take(self, report: TrackReport, now: float) -> bool:
        """True if it comes from another run than what was known, which is forgotten; a late one of a former run is
        left out."""
        if report.boot in self._former:
            return False
        other_run = report.boot != self.boot or report.uptime < self._newest - _SET_BACK_S
        known = self._newest > -math.inf
        if other_run or now < self.heard_at - _LIVELY_S:
            self._forget()
        if known and report.boot != self.boot:
            self._former.append(self.boot)
        if report.uptime >= self._newest:
            self.boot, self.sensor = report.boot, report.sensor
            self.unplaced = report.unplaced
        self._newest, self.heard_at = max(self._newest, report.uptime), now
        self._differences.append((now, now - report.uptime))
        self._take_tracks(report)
        return other_run and known

    def _take_tracks(self, report: TrackReport) -> None:
        if len(report.poses):
            rows = np.asarray(report.poses, float).copy()
            rows[:, 0] = report.uptime - rows[:, 0]
            self._poses.merge(rows)
        for each in report.objects:
            rows = np.asarray(each.samples, float).reshape(-1, 3).copy()
            if not len(rows):
                continue
            rows[:, 0] = report.uptime - rows[:, 0]
            self._objects.setdefault(each.number, Trail(3, _SPACING_S)).merge(rows)
            self._objects.move_to_end(each.number)
        while len(self._objects) > _MOST_OBJECTS:
            self._objects.popitem(last=False)

    def _forget(self) -> None:
        self._poses.clear()
        self._objects.clear()
        self._differences.clear()
        self._newest = -math.inf

    def _difference(self) -> float:
        newest = self._differences[-1][0]
        return min(value for time, value in self._differences if newest - time <= _DELAY_SPAN_S)

    def track(self) -> np.ndarray:
        """Float (n, 4: time on the own clock in s, x, y in m, yaw in rad), oldest first."""
        return self._on_own_clock(self._poses.rows)

    def fragments(self) -> Tuple[Fragment, ...]:
        """What it saw, on the own clock, of the last HISTORY_S of what it told."""
        since = self._newest - HISTORY_S
        kept = ((number, trail.rows) for number, trail in self._objects.items())
        return tuple(Fragment(number, self._on_own_clock(rows)) for number, rows in kept if rows[-1, 0] >= since)

    def lively(self, now: float) -> bool:
        """True if it told lately of an object that moves, or moved itself with one in sight."""
        if now - self.heard_at > _LIVELY_S or not self._objects:
            return False
        since = self._newest - _LIVELY_S
        trails = [trail.rows for trail in (self._poses, *self._objects.values())]
        return any(moves(rows[rows[:, 0] >= since], _LIVELY_M) for rows in trails)

    def _on_own_clock(self, rows: np.ndarray) -> np.ndarray:
        if not len(rows):
            return rows
        shifted = rows.copy()
        shifted[:, 0] += self._difference()
        return shifted
