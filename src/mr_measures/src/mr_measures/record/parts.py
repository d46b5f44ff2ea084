"""Parts of a record that every host fills in the same way: figures of a robot's true motion and of its last map."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mr_grid import OccupancyGrid, Pose
from mr_measures.figures import (
    collisions,
    coverage,
    distance_driven,
    explored_free_cells,
    moving_share,
    stalled_time,
    wrong_walls,
)
from mr_measures.record.robot_record import Contacts, MapFigures
from mr_measures.reference import MapReferenceError, error_of_map
from mr_measures.truth import Truth


@dataclass(frozen=True)
class Motion:
    """As in `RobotRecord`."""

    distance: float
    moving: float
    stalled: float
    collisions: Contacts


def motion_of(records: np.ndarray, begin: float, end: float) -> Motion:
    """`records`: true motion as in `mr_measures.motion`; the robot had a task from `begin` to `end`. Times in s since
    the start of the mission."""
    if not len(records):
        return Motion(0.0, 0.0, 0.0, Contacts())
    hits = collisions(records)
    return Motion(
        round(distance_driven(records[records["time"] <= end]), 4),
        round(moving_share(records, begin, max(begin, end)), 5),
        round(stalled_time(records), 3),
        Contacts(hits.with_walls, hits.with_robots, tuple(round(time, 3) for time in hits.times)),
    )


def map_figures_of(
    grid: OccupancyGrid, truth: Truth | None, start: Pose, error: float | None, error_reason: str
) -> MapFigures:
    """`start`: true, world frame; `error`: in percent, None for the reason given. No truth, no coverage."""
    return MapFigures(
        explored_free_cells(grid),
        None if error is None else round(error, 4),
        error_reason,
        None if truth is None else round(coverage(truth, grid, start), 5),
        None if truth is None else round(wrong_walls(truth, grid, start), 5),
    )


def error_or_reason(world: str | Path, grid: OccupancyGrid, slam: str, host: str) -> tuple[float | None, str]:
    """As `error_of_map`; what is wrong with a broken file is a reason, too."""
    try:
        return error_of_map(world, grid, slam, host)
    except MapReferenceError as fault:
        return None, str(fault)
