"""The world's truth trace: where the robots really were. Read while it grows and once more at the end."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from pathlib import Path

import numpy as np

from mr_grid import Pose
from mr_measures.motion import Row, records_of, row_of


class Track:
    """One robot."""

    def __init__(self) -> None:
        self.distance = 0.0  # m, so far
        self._rows: list[Row] = []

    @property
    def time(self) -> float:
        """Simulation time (s) of the latest row; 0 before the first."""
        return self._rows[-1][0] if self._rows else 0.0

    @property
    def place(self) -> Pose | None:
        """The latest pose, in the frame of the world."""
        return Pose(*self._rows[-1][2:5]) if self._rows else None

    def add(self, row: Row) -> None:
        if self._rows:
            self.distance += math.dist(row[2:4], self._rows[-1][2:4])
        self._rows.append(row)

    def at(self, time: float) -> Pose | None:
        """The pose at this simulation time (s), in the frame of the world; None outside of the trace."""
        index = bisect_left(self._rows, (time,))
        if index == len(self._rows) or (index == 0 and self._rows[0][0] > time):
            return None
        after, before = self._rows[index], self._rows[max(index - 1, 0)]
        share = (time - before[0]) / (after[0] - before[0]) if after[0] > before[0] else 0.0
        return Pose(*before[2:5]).interpolate(Pose(*after[2:5]), share)

    def records(self, start: float = -math.inf, end: float = math.inf) -> np.ndarray:
        """Rows between two simulation times (s), both included, as `mr_measures.motion` has them."""
        return records_of(self._rows[bisect_left(self._rows, (start,)) : bisect_right(self._rows, (end, math.inf))])


class Truth:
    """All tracks of a trace file that may still grow."""

    def __init__(self, path: Path, robots: list[str]) -> None:
        self.tracks = {name: Track() for name in robots}
        self._path = path
        self._offset = 0

    @property
    def time(self) -> float:
        """Latest simulation time in s; 0 before the first row."""
        return max((track.time for track in self.tracks.values()), default=0.0)

    def update(self) -> None:
        """Take in the complete lines written since the last call."""
        try:
            with self._path.open("rb") as file:
                file.seek(self._offset)
                data = file.read()
        except OSError:
            return
        data = data[: data.rfind(b"\n") + 1]
        self._offset += len(data)
        for line in data.decode().splitlines():
            row = row_of(line)
            if row is not None and row[0] in self.tracks:
                self.tracks[row[0]].add(row[1])

    def real_time_factor(self, start: float, end: float) -> float | None:
        """Simulated over real seconds between two simulation times; None if the trace does not cover them."""
        for track in self.tracks.values():
            records = track.records(start, end)
            if records.size >= 2:
                wall = float(records["wall"][-1] - records["wall"][0])
                return float(records["time"][-1] - records["time"][0]) / wall if wall > 0 else None
        return None
