"""Which of the transforms that robots believed were right: judged at the end of a mission, by the true motion, by where
each robot believed to be and by what its own map knew."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from map_merger.benchmark import classify
from mr_grid import Pose
from mr_measures.drift import Track, places_in_both
from mr_measures.record.judgement import judged, true_transform
from mr_measures.record.robot_record import Merge


@dataclass(frozen=True)
class Witness:
    """Of one robot. `start`: true, world frame; `poses`: where it believed to be, in its map, and when; `true`: its
    true pose at a time; `known`: (N,) since when its own map has known each reference cell. Times in s of simulation
    time."""

    start: Pose
    poses: Sequence[tuple[float, Pose]]
    true: Callable[[float], Pose | None]
    known: np.ndarray

    def track(self, until: float) -> Track:
        track = Track()
        for time, believed in self.poses:
            true = self.true(time) if time <= until else None
            if true is not None:
                track.add(self.start.between(true), believed)
        return track


class Judge:
    """`reference`: (N, 2) the reference cells, m, world frame. Robots without a witness are not judged: of those that
    were started again nobody knows which of their maps another one means."""

    def __init__(self, reference: np.ndarray, witnesses: Mapping[str, Witness]) -> None:
        self._reference = reference
        self._witnesses = witnesses

    def judge(self, robot: str, merges: Sequence[Merge], begin: float) -> tuple[Merge, ...]:
        """Entries of `robot`, whose times count from `begin` s of simulation time, with what they were."""
        return tuple(self._judged(robot, merge, merge.at + begin) for merge in merges)

    def _judged(self, robot: str, merge: Merge, now: float) -> Merge:
        target, source = self._witnesses.get(robot), self._witnesses.get(merge.partner)
        if merge.transform is None or target is None or source is None:
            return merge
        track = source.track(now)
        both = (target.known <= now) & (source.known <= now)
        shared = places_in_both(self._reference[both], target.start, target.track(now), source.start, track)
        places = self._reference[source.known <= now]
        true, points = true_transform(
            target.start.between(source.start), *shared, lambda: track.drifted(source.start.apply_inverse(places))
        )
        return judged(merge.partner, merge.at, merge.transform, true, points, classify)
