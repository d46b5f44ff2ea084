"""What is recorded over time: columns of equal length, times in s since the start of the mission.

A column that was not recorded is empty.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any

from mr_measures.record.json_form import Written

Column = Annotated[tuple[float, ...], Written.UNLESS_DEFAULT]


def _check(series: Any) -> None:
    """Raises ValueError unless times do not fall and every column is as long as they are, or empty."""
    for field in dataclasses.fields(series):
        column = getattr(series, field.name)
        if column and len(column) != len(series.time):
            raise ValueError(f"time and {field.name} differ in length: {len(series.time)} and {len(column)} values")
    if any(later < earlier for earlier, later in pairwise(series.time)):
        raise ValueError("time goes back")


@dataclass(frozen=True)
class RobotSeries:
    """True motion (m, rad, world frame), what the robot knew (m^2 of free space in its global map, and in its own local
    one), s for which it was held back, what it had sent, its bids, its state (`explorer.status.State`), and the robots
    that it heard."""

    time: Column = ()
    x: Column = ()
    y: Column = ()
    yaw: Column = ()
    explored: Column = ()
    own: Column = ()
    distance: Column = ()
    stalled: Column = ()
    bytes: Column = ()
    frames: Column = ()
    bids: Column = ()
    state: Column = ()
    neighbors: Annotated[tuple[tuple[str, ...], ...], Written.UNLESS_DEFAULT] = ()

    def __post_init__(self) -> None:
        _check(self)


@dataclass(frozen=True)
class TeamSeries:
    """What the team knew together (m^2, share of the reference cells), m driven by all robots, and their traffic."""

    time: Column = ()
    explored: Column = ()
    coverage: Column = ()
    distance: Column = ()
    bytes: Column = ()
    frames: Column = ()

    def __post_init__(self) -> None:
        _check(self)
