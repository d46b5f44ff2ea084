"""What went wrong in a mission though it came to an end: robots that are not home, contacts, transforms taken back."""

from __future__ import annotations

import math

from mr_measures.record.mission_record import MissionRecord

HOME = 1.5  # m from its start within which a robot is at home: two cannot stand on one spot


def far_from_home(record: MissionRecord) -> list[tuple[str, float]]:
    """Robots that lived, and how many m they were from their start at the end."""
    found = []
    for name, robot in record.survivors.items():
        series = robot.series
        if not series.x:
            continue
        off = math.dist((series.x[-1], series.y[-1]), robot.start[:2])
        if off > HOME:
            found.append((name, off))
    return found


def contacts(record: MissionRecord) -> dict[str, int]:
    """How often each robot that did so touched something."""
    return {name: robot.collisions.total for name, robot in record.robots.items() if robot.collisions.total}


def revoked_though_right(record: MissionRecord) -> list[tuple[str, str, float]]:
    """Robot, the other one, and when, s, of transforms that were right and were taken back."""
    found = []
    for name, robot in record.robots.items():
        right: dict[str, bool] = {}
        for merge in robot.merges or ():
            if merge.accepted:
                right[merge.partner] = bool(merge.right)
            elif right.pop(merge.partner, False):
                found.append((name, merge.partner, merge.at))
    return found
