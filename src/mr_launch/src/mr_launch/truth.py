"""The world's truth trace: where the robots really were. Read while it grows and once more at the end."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

MOVING_SPEED = 0.05  # m/s
MOVING_TURN = 0.1  # rad/s
NO_MOVEMENT = {
    "distance": 0.0,
    "moving": 0.0,
    "collisions": 0,
    "collisions_with_robots": 0,
    "stops": 0,
    "stalled_time": 0.0,
}


@dataclass
class Track:
    """One robot. Lists of equal length: time in s of simulation time, x and y in m and yaw in rad (world frame)."""

    time: list[float] = field(default_factory=list)
    wall: list[float] = field(default_factory=list)
    x: list[float] = field(default_factory=list)
    y: list[float] = field(default_factory=list)
    yaw: list[float] = field(default_factory=list)
    v: list[float] = field(default_factory=list)
    w: list[float] = field(default_factory=list)
    stalled: list[bool] = field(default_factory=list)
    collision: list[int] = field(default_factory=list)  # touched: 0 nothing, 1 a wall, 2 a robot
    distance: float = 0.0  # m, whole track

    def add(self, row: dict[str, str]) -> None:
        x, y = float(row["x"]), float(row["y"])
        if self.x:
            self.distance += float(np.hypot(x - self.x[-1], y - self.y[-1]))
        for name in ("time", "wall", "yaw", "v", "w"):
            getattr(self, name).append(float(row[name]))
        self.x.append(x)
        self.y.append(y)
        self.stalled.append(row["stalled"] not in ("0", "False", ""))
        self.collision.append(int(row["collision"]))

    def statistics(self, start: float, end: float) -> dict[str, Any]:
        """Figures of the mission between two simulation times (s)."""
        time = np.array(self.time)
        chosen = (time >= start) & (time <= end)
        if chosen.sum() < 2:
            return dict(NO_MOVEMENT)
        x, y = np.array(self.x)[chosen], np.array(self.y)[chosen]
        moving = (np.abs(np.array(self.v)[chosen]) > MOVING_SPEED) | (np.abs(np.array(self.w)[chosen]) > MOVING_TURN)
        stalled, collision = np.array(self.stalled)[chosen], np.array(self.collision)[chosen]
        step = float(np.median(np.diff(time[chosen])))
        return {
            "distance": round(float(np.hypot(np.diff(x), np.diff(y)).sum()), 2),
            "moving": round(float(moving.mean()), 3),
            "collisions": rises(collision > 0),
            "collisions_with_robots": rises(collision == 2),
            "stops": rises(~moving),
            "stalled_time": round(float(stalled.sum()) * step, 2),
        }


def rises(flags: np.ndarray) -> int:
    """How often a sequence of booleans becomes true."""
    return int(np.count_nonzero(flags[1:] & ~flags[:-1])) + int(flags[0]) if flags.size else 0


class Truth:
    """All tracks of a trace file that may still grow."""

    def __init__(self, path: Path, robots: list[str]) -> None:
        self.tracks = {name: Track() for name in robots}
        self._path = path
        self._offset = 0
        self._columns: list[str] = []

    @property
    def time(self) -> float:
        """Latest simulation time in s; 0 before the first row."""
        return max((track.time[-1] for track in self.tracks.values() if track.time), default=0.0)

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
        for row in csv.reader(io.StringIO(data.decode())):
            self._take(row)

    def _take(self, row: list[str]) -> None:
        if not row or row[0].startswith("#"):
            return
        if not self._columns:
            self._columns = row
            return
        values = dict(zip(self._columns, row))
        track = self.tracks.get(values.get("robot", ""))
        if track is not None:
            track.add(values)

    def real_time_factor(self, start: float, end: float) -> float | None:
        """Simulated over real seconds between two simulation times; None if the trace does not cover them."""
        for track in self.tracks.values():
            time = np.array(track.time)
            chosen = np.flatnonzero((time >= start) & (time <= end))
            if chosen.size >= 2:
                first, last = chosen[0], chosen[-1]
                wall = track.wall[last] - track.wall[first]
                return float(time[last] - time[first]) / wall if wall > 0 else None
        return None
