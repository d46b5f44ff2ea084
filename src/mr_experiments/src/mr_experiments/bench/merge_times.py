"""When the robots of a mission knew where the others are, and whether what they believed was right. From records."""

from __future__ import annotations

import math
from itertools import combinations, permutations
from typing import Any, Iterable, Mapping, Sequence

import numpy as np

WORST_FIRST = ("wrong", "imprecise", "right")  # what an accepted transform may be
NONE = "none"

Entry = Mapping[str, Any]
"""Of the `merges` in a record."""


def settled_at(entries: Iterable[Entry]) -> float:
    """s after the mission's start since which a robot has had a right transform of one other, infinite if it has none
    at the end. A right one that only became better counts from the first."""
    since = math.inf
    for entry in entries:
        if entry["transform"] is None or not entry["right"]:
            since = math.inf
        elif math.isinf(since):
            since = float(entry["at"])
    return since


def all_settled_at(record: Mapping[str, Any]) -> float:
    """s after the start since which every robot has had right transforms of all others; infinite if one lacks one."""
    robots = record["robots"]
    times = (settled_at(_entries(record, one, other)) for one, other in permutations(robots, 2))
    return max(times, default=math.inf)


def classes_of_pairs(record: Mapping[str, Any]) -> list[str]:
    """For every two robots the worst that either ever believed of the other: see WORST_FIRST; NONE if nothing."""
    return [
        _worst([*_entries(record, one, other), *_entries(record, other, one)])
        for one, other in combinations(record["robots"], 2)
    ]


def known_at(record: Mapping[str, Any], time: float) -> float:
    """Share of the area that the team knew together at this time in s after the start; for an infinite one infinite."""
    if math.isinf(time):
        return math.inf
    series = record["team"]["series"]
    return float(np.interp(time, series["time"], series["coverage"])) if series["time"] else 0.0


def quantile(values: Sequence[float], share: float) -> float:
    """The smallest value that this share of them does not exceed; infinite ones are such that never came."""
    if not values:
        return math.inf
    return sorted(values)[max(0, math.ceil(share * len(values)) - 1)]


def _entries(record: Mapping[str, Any], robot: str, other: str) -> list[Entry]:
    return [entry for entry in record["robots"][robot]["merges"] if entry["with"] == other]


def _worst(entries: Sequence[Entry]) -> str:
    believed = {entry["class"] for entry in entries if entry["transform"] is not None}
    return next((kind for kind in WORST_FIRST if kind in believed), NONE)
