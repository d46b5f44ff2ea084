"""How a robot's local map has drifted from the truth, and which transform between two maps is therefore true."""

from __future__ import annotations

import math

import numpy as np

from mr_grid import OccupancyGrid, Pose

MOST_POINTS = 400  # of an overlap
FEWEST_POINTS = 20  # for a fit
SPACING = 0.2  # m between the poses of a track


class Track:
    """Where a robot was and where its SLAM believed it to be. A place in its map has drifted as far as the robot had
    where it was nearest to that place."""

    def __init__(self) -> None:
        self._true: list[complex] = []
        self._believed: list[complex] = []
        self._turn: list[float] = []

    def __len__(self) -> int:
        return len(self._true)

    def add(self, true: Pose, believed: Pose) -> None:
        """`true`: in the frame that the map would have without drift, that of the start; `believed`: in the map. Poses
        near the one before are left out."""
        if self._true and abs(complex(true[0], true[1]) - self._true[-1]) < SPACING:
            return
        self._true.append(complex(true[0], true[1]))
        self._believed.append(complex(believed[0], believed[1]))
        self._turn.append(believed[2] - true[2])

    def straightened(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 2) of the map where they would be without drift."""
        return self._moved(points, np.array(self._believed), np.array(self._true), -1.0)

    def drifted(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 2) of the frame of the start where they are in the map."""
        return self._moved(points, np.array(self._true), np.array(self._believed), 1.0)

    def _moved(self, points: np.ndarray, here: np.ndarray, there: np.ndarray, sign: float) -> np.ndarray:
        places = np.ascontiguousarray(points, dtype=float).view(complex)
        if not here.size:
            return points
        nearest = np.abs(places - here[None, :]).argmin(axis=1)
        turns = np.exp(1j * sign * np.array(self._turn))
        moved = there[nearest] + turns[nearest] * (places[:, 0] - here[nearest])
        return moved[:, None].view(float)


def best_rigid_fit(target: np.ndarray, source: np.ndarray) -> Pose:
    """The transform that brings the points `source` (n, 2) nearest to `target` (n, 2): least squares."""
    target_middle, source_middle = target.mean(axis=0), source.mean(axis=0)
    to = np.ascontiguousarray(target - target_middle).view(complex)
    start = np.ascontiguousarray(source - source_middle).view(complex)
    yaw = float(np.angle(np.vdot(start, to)))
    x, y = target_middle - Pose(0.0, 0.0, yaw).apply(source_middle[None, :])[0]
    return Pose(float(x), float(y), yaw)


def overlap(
    target: OccupancyGrid, target_track: Track, source: OccupancyGrid, source_track: Track, start: Pose
) -> tuple[np.ndarray, np.ndarray]:
    """Places that both maps know, (n, 2) in either map; n is bounded. `start`: start of the source's robot in the frame
    of the target's start."""
    known = np.flatnonzero(target.cells.ravel() >= 0)
    known = known[:: max(1, math.ceil(known.size / MOST_POINTS))]
    mask = np.zeros(target.cells.size, dtype=bool)
    mask[known] = True
    in_target = target.info.centres_of(np.argwhere(mask.reshape(target.cells.shape)))
    in_source = source_track.drifted(start.inverse().apply(target_track.straightened(in_target)))
    both = source.values_at(in_source) >= 0
    return in_target[both], in_source[both]


def places_in_both(
    known: np.ndarray, target_start: Pose, target_track: Track, source_start: Pose, source_track: Track
) -> tuple[np.ndarray, np.ndarray]:
    """The same of places `known` (n, 2) by both, world frame, in which the starts are, too."""
    some = known[:: max(1, math.ceil(len(known) / MOST_POINTS))]
    return (
        target_track.drifted(target_start.apply_inverse(some)),
        source_track.drifted(source_start.apply_inverse(some)),
    )
