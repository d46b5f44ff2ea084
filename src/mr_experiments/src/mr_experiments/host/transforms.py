"""Which transforms between robots were believed, when, and how right they were."""

from __future__ import annotations

from typing import Sequence

import numpy as np

from map_merger.benchmark import classify
from map_merger.transform import displacement, rotation_between
from mr_experiments.host.robot import Robot
from mr_grid import Pose
from mr_measures.drift import FEWEST_POINTS, Track, best_rigid_fit, overlap
from mr_measures.occupancy import occupancy_of
from mr_measures.record.beliefs import Beliefs
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
        true, points = self._truth(robot, other)
        offsets = displacement(transform, true, points)
        turn = rotation_between(transform, true)
        kind = classify(offsets, turn)
        return Merge(
            other.name,
            round(now, 3),
            Pose(round(transform.x, 4), round(transform.y, 4), round(transform.yaw, 5)),
            round(float(offsets.max()), 4),
            round(turn, 5),
            kind,
            kind != "wrong",
        )

    def _truth(self, robot: Robot, other: Robot) -> tuple[Pose, np.ndarray]:
        """The best rigid fit over what both maps know, and those places (n, 2) in the other's map. Where they share too
        little, that of the starts and all of the other's map."""
        start = Pose(*self._starts[robot.name].between(self._starts[other.name]))
        target, source = occupancy_of(robot.local_map), occupancy_of(other.local_map)
        target_points, source_points = overlap(
            target, self._tracks[robot.name], source, self._tracks[other.name], start
        )
        if len(source_points) >= FEWEST_POINTS:
            return best_rigid_fit(target_points, source_points), source_points
        places = source.info.centres_of(np.argwhere(source.cells >= 0))
        return start, places if len(places) else np.zeros((1, 2))
