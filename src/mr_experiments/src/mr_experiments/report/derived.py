"""Figures of one mission that follow from its record."""

from __future__ import annotations

from itertools import permutations
from typing import Iterable

from mr_measures.record.mission_record import MissionRecord
from mr_measures.record.robot_record import Merge


def balance(record: MissionRecord) -> float | None:
    """Longest distance of a robot over the mean of its team: 1 when all drive equally far. None when nobody drives."""
    distances = [robot.distance for robot in record.robots.values()]
    mean = sum(distances) / len(distances) if distances else 0.0
    return max(distances) / mean if mean > 0.0 else None


def moving_share(record: MissionRecord) -> float | None:
    """Mean over the robots."""
    return mean(robot.moving for robot in record.robots.values())


def all_merged_at(record: MissionRecord) -> float | None:
    """Time at which for the first time every robot holds a transform to every other one. None if that never happens."""
    wanted = set(permutations(record.robots, 2))
    events = [(name, merge) for name, robot in record.robots.items() for merge in robot.merges or ()]
    held: set[tuple[str, str]] = set()
    for robot, merge in sorted(events, key=lambda event: event[1].at):
        (held.add if merge.accepted else held.discard)((robot, merge.partner))
        if held >= wanted:
            return merge.at
    return None


def merges_at_end(record: MissionRecord) -> tuple[int, int]:
    """Transforms that are right and that are wrong when the mission ends."""
    last = {
        (name, merge.partner): merge
        for name, robot in record.robots.items()
        for merge in sorted(robot.merges or (), key=_time)
    }
    right = sum(merge.accepted and merge.right is True for merge in last.values())
    wrong = sum(merge.accepted and merge.right is False for merge in last.values())
    return right, wrong


def _time(merge: Merge) -> float:
    return merge.at


def present(values: Iterable[float | None]) -> list[float]:
    return [value for value in values if value is not None]


def mean(values: Iterable[float | None]) -> float | None:
    """Of the values that exist; None if there are none."""
    numbers = present(values)
    return sum(numbers) / len(numbers) if numbers else None
