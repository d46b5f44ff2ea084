"""Which transforms between robots were believed, when, and how right they were."""

from __future__ import annotations

from typing import Sequence

import numpy as np

from map_merger.benchmark import classify
from mr_experiments.host.robot import Robot
from mr_grid import Pose
from mr_measures.drift import Track, overlap
from mr_measures.occupancy import occupancy_of
from mr_measures.record.beliefs import Beliefs
from mr_measures.record.judgement import judged, true_transform
from mr_measures.record.robot_record import Merge


class MergeLog:
    """`starts`: true start poses, world frame, of `robots`."""

    def __init__(self, starts: Sequence[Pose], names: Sequence[str]) -> None:
        self._starts = dict(zip(names, starts))
        self._tracks = {name: Track() for name in names}
        self._beliefs = {name: Beliefs() for name in names}
        self.entries: dict[str, list[Merge]] = {name: [] for name in names}

    def follow(self, robot: Robot, true: Pose) -> None:
        """Notes where a robot is, world frame, and where it believes to be."""
        if robot.body.pose is not None:
            self._tracks[robot.name].add(self._starts[robot.name].between(true), robot.body.pose)

    def look(self, robot: Robot, team: Sequence[Robot], now: float) -> None:
        """Notes what has changed in the transforms of a robot's merger; later refinements count only for the error."""
        partners = {one.name: one for one in team}
        present = {name: transform for name, transform in robot.merger.transforms().items() if name in partners}
        for other, transform in self._beliefs[robot.name].changes(present):
            lost = Merge(other, round(now, 3), None)
            entry = lost if transform is None else self._entry(robot, partners[other], transform, now)
            self.entries[robot.name].append(entry)

    def _entry(self, robot: Robot, other: Robot, transform: Pose, now: float) -> Merge:
        """Judged by the places that both maps know now."""
        start = Pose(*self._starts[robot.name].between(self._starts[other.name]))
        target, source = occupancy_of(robot.local_map), occupancy_of(other.local_map)
        shared = overlap(target, self._tracks[robot.name], source, self._tracks[other.name], start)
        true, points = true_transform(start, *shared, lambda: source.info.centres_of(np.argwhere(source.cells >= 0)))
        return judged(other.name, now, transform, true, points, classify)
