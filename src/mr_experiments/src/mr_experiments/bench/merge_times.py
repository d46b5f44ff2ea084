"""When the robots of a mission knew where the others are, and whether what they believed was right. From records."""

from __future__ import annotations

import math
from itertools import combinations, permutations
from typing import Iterable, Sequence

import numpy as np

from mr_measures.record.mission_record import MissionRecord
from mr_measures.record.robot_record import Merge

WORST_FIRST = ("wrong", "imprecise", "right")  # what an accepted transform may be
NONE = "none"


def settled_at(merges: Iterable[Merge]) -> float:
    """s after the mission's start since which a robot has had a right transform of one other, infinite if it has none
    at the end. A right one that only became better counts from the first."""
    since = math.inf
    for merge in merges:
        if not (merge.accepted and merge.right):
            since = math.inf
        elif math.isinf(since):
            since = merge.at
    return since


def all_settled_at(record: MissionRecord) -> float:
    """s after the start since which every robot has had right transforms of all others; infinite if one lacks one."""
    times = (settled_at(_merges(record, one, other)) for one, other in permutations(record.robots, 2))
    return max(times, default=math.inf)


def classes_of_pairs(record: MissionRecord) -> list[str]:
    """For every two robots the worst that either ever believed of the other: see WORST_FIRST; NONE if nothing."""
    return [
        _worst([*_merges(record, one, other), *_merges(record, other, one)])
        for one, other in combinations(record.robots, 2)
    ]


def known_at(record: MissionRecord, time: float) -> float:
    """Share of the area that the team knew together at this time in s after the start; for an infinite one infinite."""
    if math.isinf(time):
        return math.inf
    series = record.team.series
    return float(np.interp(time, series.time, series.coverage)) if series.time else 0.0


def quantile(values: Sequence[float], share: float) -> float:
    """The smallest value that this share of them does not exceed; infinite ones are such that never came."""
    if not values:
        return math.inf
    return sorted(values)[max(0, math.ceil(share * len(values)) - 1)]


def _merges(record: MissionRecord, robot: str, other: str) -> list[Merge]:
    return [merge for merge in record.robots[robot].merges or () if merge.partner == other]


def _worst(merges: Sequence[Merge]) -> str:
    believed = {merge.kind for merge in merges if merge.accepted}
    return next((kind for kind in WORST_FIRST if kind in believed), NONE)
