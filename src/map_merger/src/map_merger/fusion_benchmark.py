"""Measures the global map: time and memory of updates of a large team, quality of merged maps of synthetic teams.

Wrong walls: share of the obstacle cells farther than 0.15 m from a true wall. Seams: free cells beside unknown ones
that some map holds as known, and beside no obstacle: what an explorer would take for a frontier and is none.
"""

import math
import resource
import time
from typing import Any, Dict, List, NamedTuple

import cv2
import numpy as np

from mr_grid import FREE, OCCUPIED, UNKNOWN, GridInfo, OccupancyGrid, Pose, values_at

from .global_map import GlobalMap, Policy
from .grid import Box, free_cells, occupied_cells
from .robot_size import USUAL_SIZE
from .synthetic import FloorPlan, RobotMap, Survey, Surveyor, office_plan

Row = Dict[str, Any]
TEAM = 4
WALL_TOLERANCE_M = 0.15
_POSE_ERROR_M, _POSE_ERROR_RAD = 0.02, math.radians(0.15)
"""Standard deviation of the transforms between the synthetic robots."""
_MARGIN = 20
"""Cells around the plan in which a wall may be drawn."""


class Quality(NamedTuple):
    """Of one merged map: wrong walls in percent, seams in cells."""

    wrong_walls: float
    seams: int


def row(what: str, bar: str, value: float, unit: str, holds: bool, detail: str) -> Row:
    """A row of the table."""
    return {"what": what, "bar": bar, "value": value, "unit": unit, "holds": holds, "detail": detail}


# Time and memory


def timing_rows(robots: int, edge: int, updates: int, seed: int, command: str) -> List[Row]:
    """Updates of one tile of 32 x 32 cells, message included, in a team whose maps of `edge` x `edge` cells overlap."""
    random = np.random.default_rng(seed)
    plan = large_map(random, edge)
    merged = GlobalMap("robot_0", USUAL_SIZE)
    merged.set_local(plan)
    transforms = [Pose(*(random.normal(0.0, (0.5, 0.5, 0.05)).tolist())) for _ in range(robots - 1)]
    maps = [OccupancyGrid(plan.info, plan.cells.copy()) for _ in transforms]
    for number, transform in enumerate(transforms):
        merged.set_layer(f"robot_{number + 1}", maps[number], 0, transform)
        merged.set_places(f"robot_{number + 1}", random.uniform(0.0, edge * 0.05, (1000, 2)))
    began = time.process_time()
    _published(merged)
    first = time.process_time() - began
    seconds = [_timed_update(merged, random, maps, transforms, version) for version in range(1, updates + 1)]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    detail = (
        f"{robots} robots, {edge} x {edge} cells, {updates} updates, all at once {first:.2f} s, seed {seed}; {command}"
    )
    median, longest = 1e3 * float(np.median(seconds)), 1e3 * max(seconds)
    return [
        row("global map after one tile, median", "<= 50", round(median, 1), "ms", median <= 50.0, detail),
        row("global map after one tile, longest", "<= 50", round(longest, 1), "ms", longest <= 50.0, detail),
        row("peak memory of the process", "<= 300", round(peak), "MB", peak <= 300.0, detail),
    ]


def large_map(random: np.random.Generator, edge: int) -> OccupancyGrid:
    """Rooms of 5 m over the whole of `edge` x `edge` cells, with furniture."""
    cells = np.zeros((edge, edge), np.int8)
    cells[::100], cells[:, ::100] = OCCUPIED, OCCUPIED
    for top in range(0, edge, 100):
        for left in range(0, edge, 100):
            cells[top + 40 : top + 60, left], cells[top, left + 40 : left + 60] = FREE, FREE
            row_, column = random.integers(10, 80, 2)
            cells[top + row_ : top + row_ + 12, left + column : left + column + 12] = OCCUPIED
    cells[random.random(cells.shape) < 0.1] = UNKNOWN
    return OccupancyGrid(GridInfo(edge, edge, 0.05), cells)


def _timed_update(
    merged: GlobalMap, random: np.random.Generator, maps: List[OccupancyGrid], transforms: List[Pose], version: int
) -> float:
    """CPU seconds from a new tile to the message."""
    number = version % len(maps)
    top, left = (int(value) for value in random.integers(0, maps[number].info.height - 32, 2))
    tile = Box(top, left, top + 32, left + 32)
    cells = maps[number].cells.copy()
    cells[tile.slices()] = random.choice([UNKNOWN, FREE, OCCUPIED], (32, 32))
    maps[number] = OccupancyGrid(maps[number].info, cells)
    began = time.process_time()
    merged.set_layer(f"robot_{number + 1}", maps[number], version, transforms[number], tile)
    _published(merged)
    return time.process_time() - began


def _published(merged: GlobalMap) -> bytes:
    """The data of an OccupancyGrid as it goes out."""
    update = merged.render()
    return b"" if update is None else update.grid.cells.tobytes()


# Quality


class Team(NamedTuple):
    """Robots in a building, and the transforms to the frame of the first that they believe in."""

    plan: FloorPlan
    robots: List[RobotMap]
    transforms: List[Pose]


def quality_rows(teams: int, seed: int, command: str) -> List[Row]:
    """Merged maps of synthetic teams of TEAM robots with drift and inexact transforms."""
    found: Dict[Policy, List[Quality]] = {policy: [] for policy in Policy}
    for number in range(seed, seed + teams):
        team = synthetic_team(np.random.default_rng(number))
        for policy in Policy:
            found[policy].append(quality_of(team, merged_map(team, policy)))
    detail = f"{teams} teams of {TEAM}, seeds {seed}..{seed + teams - 1}; {command}"
    return [each for policy in Policy for each in _rows_of(policy.value, found[policy], detail)]


def _rows_of(policy: str, found: List[Quality], detail: str) -> List[Row]:
    wrong = np.array([each.wrong_walls for each in found])
    seams = float(np.mean([each.seams for each in found]))
    return [
        row(f"{policy}: wrong walls, mean", "<= 0.5", round(wrong.mean(), 3), "%", bool(wrong.mean() <= 0.5), detail),
        row(f"{policy}: wrong walls, worst map", "<= 3", round(wrong.max(), 3), "%", bool(wrong.max() <= 3.0), detail),
        row(f"{policy}: seams, mean", "<= 10", round(seams, 1), "cells", seams <= 10.0, detail),
    ]


def synthetic_team(random: np.random.Generator) -> Team:
    """Robots that start within sight of one another in an office."""
    plan = office_plan(random, rooms=4)
    surveyor = Surveyor(plan)
    survey = Survey(path_length=30.0, drift=0.03)
    first = surveyor.explore(random, survey)
    robots, transforms = [first], [Pose()]
    for _ in range(TEAM - 1):
        x, y = first.path[0, :2] + random.uniform(-1.5, 1.5, 2)
        robots.append(surveyor.explore(random, survey, start=(float(x), float(y))))
        error = random.normal(0.0, (_POSE_ERROR_M, _POSE_ERROR_M, _POSE_ERROR_RAD))
        truth = first.start.inverse().compose(robots[-1].start)
        transforms.append(truth.compose(Pose(*error.tolist())))
    return Team(plan, robots, transforms)


def merged_map(team: Team, policy: Policy) -> OccupancyGrid:
    """The global map of the first robot."""
    merged = GlobalMap("0", USUAL_SIZE, policy)
    merged.set_local(team.robots[0].grid)
    for number, (robot, transform) in enumerate(zip(team.robots, team.transforms)):
        if number:
            merged.set_layer(str(number), robot.grid, 0, transform)
        path = robot.start.inverse().apply(robot.path[:, :2])
        merged.set_places(str(number), transform.apply(path))
    update = merged.render()
    assert update is not None
    return update.grid


def quality_of(team: Team, merged: OccupancyGrid) -> Quality:
    """Of a map merged in the frame of the first robot."""
    rows, columns = np.indices(merged.cells.shape)
    points = merged.info.centres(rows.ravel(), columns.ravel())
    known = np.zeros(len(points), bool)
    to_wall = _distance_to_walls(team.plan, team.robots[0].start.apply(points))
    for robot, transform in zip(team.robots, team.transforms):
        seen = values_at(robot.grid.cells, robot.grid.info, transform.inverse().apply(points), UNKNOWN)
        known |= seen != UNKNOWN
    wrong = to_wall[occupied_cells(merged).ravel()] > WALL_TOLERANCE_M + team.plan.resolution / 2.0
    return Quality(100.0 * float(wrong.mean()), _seams(merged, known.reshape(merged.cells.shape)))


def _distance_to_walls(plan: FloorPlan, points: np.ndarray) -> np.ndarray:
    """Metres from points of the world to the middle of the next wall cell, 0 in walls, infinite far outside, (n,)."""
    walls = np.pad(plan.walls, _MARGIN)
    corner = -_MARGIN * plan.resolution
    info = GridInfo(walls.shape[1], walls.shape[0], plan.resolution, Pose(corner, corner))
    cells = cv2.distanceTransform((~walls).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return values_at(cells * plan.resolution, info, points, math.inf)


def _seams(merged: OccupancyGrid, known: np.ndarray) -> int:
    kernel = np.ones((3, 3), np.uint8)
    lost = cv2.dilate(((merged.cells == UNKNOWN) & known).astype(np.uint8), kernel).astype(bool)
    beside_wall = cv2.dilate(occupied_cells(merged).astype(np.uint8), kernel).astype(bool)
    return int((free_cells(merged) & lost & ~beside_wall).sum())
