"""Pairs of partial maps with known transform, from floor plans: what tests and benchmark measure registration on.

Everything is drawn from the generator that is passed in, so a seed repeats a pair.
"""

import math
from dataclasses import dataclass
from typing import List, NamedTuple, Optional, Sequence, Tuple

import cv2
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from .grid import FREE, OCCUPIED, UNKNOWN, Grid, GridInfo
from .transform import Transform

_COARSE = 4
"""Cells of the floor plan per node of the path planner."""


@dataclass(frozen=True, eq=False)
class FloorPlan:
    """A building: walls (bool, row 0 at the south), metres per cell; the world's origin is its south-west corner.

    aliases: motions that lay much of the building on exact copies.
    """

    walls: np.ndarray
    resolution: float = 0.05
    aliases: Tuple[Transform, ...] = ()

    def holds(self, place: np.ndarray) -> bool:
        """True if the place (x, y) in metres is inside the building."""
        rows, columns = self.walls.shape
        return bool(0.0 < place[0] < columns * self.resolution and 0.0 < place[1] < rows * self.resolution)


@dataclass(frozen=True)
class Survey:
    """How a robot maps. Lengths in metres, angles in radians."""

    beams: int = 361
    view: float = math.radians(270.0)
    reach: float = 8.0
    range_noise: float = 0.01
    step: float = 0.4
    path_length: float = 12.0
    drift: float = 0.0
    """Standard deviation to which the pose error wanders over the whole path (m; a fifth of it per metre as rad)."""
    smudges: int = 0
    """Scans that see another robot in the way."""
    resolution: float = 0.05
    stages: Tuple[float, ...] = (1.0,)
    """Shares of the path after which the map is kept."""


class RobotMap(NamedTuple):
    """Local map in the frame of its start pose as it grew, the true start pose and the path (n, 3) in the world."""

    stages: Tuple[Grid, ...]
    start: Transform
    path: np.ndarray

    @property
    def grid(self) -> Grid:
        """The map at the end."""
        return self.stages[-1]


class Pair(NamedTuple):
    """Two maps and the true transform source -> target."""

    target: RobotMap
    source: RobotMap
    truth: Transform


def plan_from_image(path: str, resolution: float) -> FloorPlan:
    """Floor plan from an image, dark = wall, first image row at the north; FileNotFoundError if it cannot be read."""
    image = cv2.imread(path, cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise FileNotFoundError(f"no readable image at {path}")
    return FloorPlan(np.ascontiguousarray(image[::-1] < 128), resolution)


class Room(NamedTuple):
    """Furniture (bool, row 0 at the outer wall of the south side) and the column at which the door begins."""

    furniture: np.ndarray
    door: int

    def turned(self) -> "Room":
        """The room as it is on the other side of the corridor of a building that is turned by 180 degrees."""
        return Room(self.furniture[::-1, ::-1], _PITCH - self.door - _DOOR + 1)


_PITCH, _DEPTH, _CORRIDOR, _DOOR = 82, 98, 46, 20
"""Cells of 0.05 m: room to room, outer wall to corridor wall, width of the corridor, of a door."""


def office_plan(random: np.random.Generator, rooms: int = 6, same: bool = False) -> FloorPlan:
    """Two rows of rooms of 4.1 m x 4.9 m along a corridor; with `same` all rooms of a row are exact copies."""
    rows = []
    for _ in range(2):
        room = _room(random)
        rows.append([room if same else _room(random) for _ in range(rooms)])
    return _assembled(rows, [_shifted(distance) for distance in range(1, rooms)] if same else [])


def turned_copies_plan(random: np.random.Generator, rooms: int = 6) -> FloorPlan:
    """All rooms are copies of one; on the north side of the corridor they are turned by 180 degrees."""
    room = _room(random)
    copies = [_shifted(distance) for distance in range(1, rooms)]
    turns = [_turned((rooms + distance) * _PITCH) for distance in range(1 - rooms, rooms)]
    return _assembled([[room] * rooms, [room.turned()] * rooms], copies + turns, even=True)


def bare_rooms_plan(random: np.random.Generator, rooms: int = 6) -> FloorPlan:
    """Equal rooms without furniture, doors opposite one another: turned by 180 degrees the corridor is the same."""
    room = Room(np.zeros((_DEPTH - 2, _PITCH - 1), bool), (_PITCH - _DOOR) // 2)
    copies = [_shifted(distance) for distance in range(1, rooms)]
    turns = [_turned((rooms + distance) * _PITCH) for distance in range(1 - rooms, rooms)]
    return _assembled([[room] * rooms, [room.turned()] * rooms], copies + turns, even=True)


def symmetric_plan(random: np.random.Generator, rooms: int = 6) -> FloorPlan:
    """All rooms of the south side differ; the whole building is the same when turned by 180 degrees."""
    south = [_room(random) for _ in range(rooms)]
    return _assembled([south, [room.turned() for room in reversed(south)]], [_turned(rooms * _PITCH)], even=True)


def long_corridor_plan(random: np.random.Generator, rooms: int = 7) -> FloorPlan:
    """A corridor of 28 m without doors but at its ends, where copies of one pair of rooms are."""
    ends = [_room(random), _room(random)]
    rows = [[end] + [None] * (rooms - 2) + [end] for end in ends]
    return _assembled(rows, [_shifted(rooms - 1)])


def _assembled(rows: Sequence[Sequence[Optional[Room]]], aliases: Sequence[Transform], even: bool = False) -> FloorPlan:
    """South and north row of rooms along a corridor; None is solid. `even`: the north row is as deep as the south row
    to the cell."""
    width, height = len(rows[0]) * _PITCH + 1, 2 * _DEPTH + _CORRIDOR + 2
    walls = np.zeros((height, width), bool)
    walls[[0, -1]] = True
    walls[:, [0, -1]] = True
    north = _DEPTH + _CORRIDOR + even
    for row, inner, outer, bottom in (
        (rows[0], _DEPTH, slice(0, _DEPTH), 1),
        (rows[1], north, slice(north, height), north + 1 + even),
    ):
        walls[inner] = True
        for number, room in enumerate(row):
            left = number * _PITCH
            if room is None:
                walls[outer, left : left + _PITCH] = True
                continue
            walls[outer, left] = True
            walls[bottom : bottom + _DEPTH - 2, left + 1 : left + _PITCH] |= room.furniture
            walls[inner, left + room.door : left + room.door + _DOOR] = False
    return FloorPlan(walls, aliases=tuple(aliases))


def _shifted(rooms: int) -> Transform:
    return Transform(rooms * _PITCH * 0.05, 0.0, 0.0)


def _turned(length: int) -> Transform:
    """The turn by 180 degrees that lays the west wall at the column `length`."""
    return Transform((length + 1) * 0.05, (2 * _DEPTH + _CORRIDOR + 2) * 0.05, math.pi)


def _room(random: np.random.Generator) -> Room:
    return Room(_furniture(random, _DEPTH - 2, _PITCH - 1), int(random.integers(8, _PITCH - 30)))


def _furniture(random: np.random.Generator, rows: int, columns: int) -> np.ndarray:
    mask = np.zeros((rows, columns), bool)
    for _ in range(int(random.integers(1, 4))):
        height, width = random.integers(8, 26, 2)
        top, left = int(random.integers(0, rows - height)), int(random.integers(0, columns - width))
        if top > 24 and top + height < rows - 24:
            mask[top : top + height, left : left + width] = True
        elif random.random() < 0.5:
            mask[top : top + height, : width // 2] = True
    return mask


class Surveyor:
    """Drives imaginary robots through a floor plan and draws their maps."""

    def __init__(self, plan: FloorPlan, clearance: float = 0.25) -> None:
        self.plan = plan
        kernel = 2 * math.ceil(clearance / plan.resolution) + 1
        blocked = cv2.dilate(plan.walls.astype(np.uint8), np.ones((kernel, kernel), np.uint8))
        rows, columns = (size // _COARSE * _COARSE for size in blocked.shape)
        blocks = blocked[:rows, :columns].reshape(rows // _COARSE, _COARSE, columns // _COARSE, _COARSE)
        self._open = blocks.max(axis=(1, 3)) == 0
        self._graph = _lattice_graph(self._open)

    def explore(
        self,
        random: np.random.Generator,
        survey: Survey,
        start: Optional[Tuple[float, float]] = None,
        yaw: Optional[float] = None,
    ) -> RobotMap:
        """Map of a robot that wanders from `start` (m, in the world; anywhere if None) for the survey's path length."""
        path = self._wander(random, survey, start)
        headings = np.unwrap(np.arctan2(*np.gradient(path, axis=0).T[::-1])) if len(path) > 1 else np.zeros(1)
        poses = np.column_stack([path, headings])
        if yaw is not None:
            poses[0, 2] = yaw
        begin = Transform(*(float(value) for value in poses[0]))
        return RobotMap(self._draw(random, survey, poses, begin), begin, poses)

    def _wander(self, random: np.random.Generator, survey: Survey, start: Optional[Tuple[float, float]]) -> np.ndarray:
        cell = self.plan.resolution * _COARSE
        open_nodes = np.flatnonzero(self._open)
        node = int(random.choice(open_nodes)) if start is None else self._node_at(start)
        points = [self._centre(node)]
        travelled = 0.0
        while travelled < survey.path_length:
            distance, before = dijkstra(self._graph, indices=node, return_predecessors=True, limit=15.0 / cell)
            reachable = np.flatnonzero(np.isfinite(distance) & (distance > 1.0 / cell))
            if reachable.size == 0:
                break
            goal = int(random.choice(reachable))
            leg = [goal]
            while leg[-1] != node:
                leg.append(int(before[leg[-1]]))
            for step in leg[::-1][1:]:
                points.append(self._centre(step))
                travelled += float(np.hypot(*(points[-1] - points[-2])))
                if travelled >= survey.path_length:
                    break
            node = goal
        return _resampled(np.array(points), survey.step)

    def _node_at(self, place: Tuple[float, float]) -> int:
        cell = self.plan.resolution * _COARSE
        rows, columns = np.nonzero(self._open)
        nearest = int(np.argmin(np.hypot((columns + 0.5) * cell - place[0], (rows + 0.5) * cell - place[1])))
        return int(rows[nearest] * self._open.shape[1] + columns[nearest])

    def _centre(self, node: int) -> np.ndarray:
        cell = self.plan.resolution * _COARSE
        row, column = divmod(node, self._open.shape[1])
        return np.array([(column + 0.5) * cell, (row + 0.5) * cell])

    def _draw(
        self, random: np.random.Generator, survey: Survey, poses: np.ndarray, begin: Transform
    ) -> Tuple[Grid, ...]:
        error = _wandering_error(random, survey, len(poses))
        smudged = set(random.choice(len(poses), min(survey.smudges, len(poses)), replace=False).tolist())
        to_map = begin.inverse()
        reach = survey.reach + 1.0
        path = to_map.apply(poses[:, :2])
        low = np.floor((path.min(axis=0) - reach) / survey.resolution) * survey.resolution + random.uniform(
            -0.5, 0.5, 2
        )
        columns, rows = np.ceil((path.max(axis=0) + reach - low) / survey.resolution).astype(int)
        info = GridInfo(int(columns), int(rows), survey.resolution, Transform(float(low[0]), float(low[1]), 0.0))
        hits, passes = np.zeros(info.shape, np.int32), np.zeros(info.shape, np.int32)
        ends = [max(1, round(share * len(poses))) - 1 for share in survey.stages]
        stages: List[Grid] = []
        for index, pose in enumerate(poses):
            walls = self._with_smudge(random, pose) if index in smudged else self.plan.walls
            ranges = cast(walls, self.plan.resolution, pose, survey)
            ranges = np.where(
                ranges < survey.reach, ranges + random.normal(0.0, survey.range_noise, ranges.size), ranges
            )
            seen = to_map.compose(Transform(*(float(value) for value in pose))).compose(error[index])
            _integrate(info, hits, passes, seen, ranges, survey)
            stages.extend([_grid_from(info, hits, passes)] * ends.count(index))
        return tuple(stages)

    def _with_smudge(self, random: np.random.Generator, pose: np.ndarray) -> np.ndarray:
        walls = self.plan.walls.astype(np.uint8)
        angle = pose[2] + random.uniform(-1.5, 1.5)
        centre = pose[:2] + random.uniform(0.8, 2.0) * np.array([math.cos(angle), math.sin(angle)])
        column, row = (round(value) for value in (centre / self.plan.resolution).tolist())
        cv2.circle(walls, (column, row), round(0.2 / self.plan.resolution), 1, -1)
        return walls.astype(bool)


def _grid_from(info: GridInfo, hits: np.ndarray, passes: np.ndarray) -> Grid:
    cells = np.full(info.shape, UNKNOWN, np.int8)
    cells[passes > 0] = FREE
    cells[(hits > 0) & (3 * hits >= passes)] = OCCUPIED
    return Grid(info, cells)


def cast(walls: np.ndarray, resolution: float, pose: Sequence[float], survey: Survey) -> np.ndarray:
    """Ranges in metres of the survey's beams from `pose` (x, y, yaw); the reach where nothing is hit."""
    angles = pose[2] + np.linspace(-survey.view / 2, survey.view / 2, survey.beams)
    distances = np.arange(0.0, survey.reach, 0.4 * resolution)
    columns = ((pose[0] + distances * np.cos(angles)[:, None]) / resolution).astype(np.int32)
    rows = ((pose[1] + distances * np.sin(angles)[:, None]) / resolution).astype(np.int32)
    np.clip(columns, 0, walls.shape[1] - 1, out=columns)
    np.clip(rows, 0, walls.shape[0] - 1, out=rows)
    blocked = walls[rows, columns]
    return np.where(blocked.any(axis=1), distances[blocked.argmax(axis=1)], survey.reach)


def _integrate(
    info: GridInfo, hits: np.ndarray, passes: np.ndarray, pose: Transform, ranges: np.ndarray, survey: Survey
) -> None:
    angles = pose.yaw + np.linspace(-survey.view / 2, survey.view / 2, survey.beams)
    distances = np.arange(0.0, survey.reach, 0.7 * info.resolution)
    x = (pose.x - info.origin.x + distances * np.cos(angles)[:, None]) / info.resolution
    y = (pose.y - info.origin.y + distances * np.sin(angles)[:, None]) / info.resolution
    flat = np.floor(y).astype(np.int64) * info.width + np.floor(x).astype(np.int64)
    passed = np.unique(flat[distances < ranges[:, None] - 0.5 * info.resolution])
    hit = ranges < survey.reach
    end_x = (pose.x - info.origin.x + ranges[hit] * np.cos(angles[hit])) / info.resolution
    end_y = (pose.y - info.origin.y + ranges[hit] * np.sin(angles[hit])) / info.resolution
    ends = np.unique(np.floor(end_y).astype(np.int64) * info.width + np.floor(end_x).astype(np.int64))
    passed = np.setdiff1d(passed, ends, assume_unique=True)
    hits.ravel()[ends] += 1
    passes.ravel()[passed] += 1


def _wandering_error(random: np.random.Generator, survey: Survey, count: int) -> List[Transform]:
    if survey.drift == 0.0 or count < 2:
        return [Transform()] * count
    steps = random.normal(0.0, 1.0, (count, 3)) / math.sqrt(count) * (survey.drift, survey.drift, 0.2 * survey.drift)
    steps[0] = 0.0
    return [Transform(*(float(value) for value in row)) for row in steps.cumsum(axis=0)]


def _resampled(points: np.ndarray, step: float) -> np.ndarray:
    if len(points) < 2:
        return points
    along = np.concatenate([[0.0], np.hypot(*np.diff(points, axis=0).T).cumsum()])
    wanted = np.arange(0.0, along[-1], step)
    return np.column_stack([np.interp(wanted, along, points[:, axis]) for axis in (0, 1)])


def _lattice_graph(open_cells: np.ndarray) -> coo_matrix:
    rows, columns = open_cells.shape
    index = np.arange(rows * columns).reshape(rows, columns)
    begins, ends, costs = [], [], []
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here = (slice(0, rows - down), slice(max(0, -right), columns - max(0, right)))
        there = (slice(down, rows), slice(max(0, right), columns + min(0, right)))
        both = open_cells[here] & open_cells[there]
        begins.append(index[here][both])
        ends.append(index[there][both])
        costs.append(np.full(int(both.sum()), math.hypot(down, right)))
    begin, end, cost = (np.concatenate(parts) for parts in (begins, ends, costs))
    size = rows * columns
    return coo_matrix(
        (np.concatenate([cost, cost]), (np.concatenate([begin, end]), np.concatenate([end, begin]))), shape=(size, size)
    ).tocsr()


def pair_of(target: RobotMap, source: RobotMap) -> Pair:
    """The pair with its true transform."""
    return Pair(target, source, target.start.inverse().compose(source.start))
