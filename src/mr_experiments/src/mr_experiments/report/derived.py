"""Figures of one mission that follow from its record."""

from __future__ import annotations

from typing import Iterable

from mr_experiments.report.record_set import Merge, Record


def balance(record: Record) -> float | None:
    """Longest distance of a robot over the mean of its team: 1 when all drive equally far. None when nobody drives."""
    distances = [robot.distance for robot in record.robots]
    mean = sum(distances) / len(distances) if distances else 0.0
    return max(distances) / mean if mean > 0.0 else None


def moving_share(record: Record) -> float | None:
    """Mean over the robots."""
    return mean(robot.moving for robot in record.robots)


def all_merged_at(record: Record) -> float | None:
    """Time at which for the first time every robot holds a transform to every other one. None if that never happens."""
    wanted = {(a.name, b.name) for a in record.robots for b in record.robots if a is not b}
    events = [(robot.name, merge) for robot in record.robots for merge in robot.merges]
    held: set[tuple[str, str]] = set()
    for robot, merge in sorted(events, key=lambda event: event[1].at):
        (held.add if merge.accepted else held.discard)((robot, merge.partner))
        if held >= wanted:
            return merge.at
    return None


def merges_at_end(record: Record) -> tuple[int, int]:
    """Transforms that are right and that are wrong when the mission ends."""
    last = {(robot.name, merge.partner): merge for robot in record.robots for merge in sorted(robot.merges, key=_time)}
    right = sum(merge.accepted and merge.right for merge in last.values())
    wrong = sum(merge.accepted and not merge.right for merge in last.values())
    return right, wrong


def _time(merge: Merge) -> float:
    return merge.at


def present(values: Iterable[float | None]) -> list[float]:
    return [value for value in values if value is not None]


def mean(values: Iterable[float | None]) -> float | None:
    """Of the values that exist; None if there are none."""
    numbers = present(values)
    return sum(numbers) / len(numbers) if numbers else None
