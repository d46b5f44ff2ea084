"""Imaginary robots that drive through floor plans, and the pairs of maps that they bring home."""

import math
from typing import List, NamedTuple, Optional, Sequence, Tuple

import cv2
import numpy as np

from mr_grid import OccupancyGrid, Pose
from mr_plans import FloorPlan

from .paths import Wanderer
from .scanning import GridDrawer, Survey, cast, info_around


class RobotMap(NamedTuple):
    """Local map in the frame of its start pose as it grew, the true start pose and the path (n, 3) in the world."""

    stages: Tuple[OccupancyGrid, ...]
    start: Pose
    path: np.ndarray

    @property
    def grid(self) -> OccupancyGrid:
        """The map at the end."""
        return self.stages[-1]


class Pair(NamedTuple):
    """Two maps and the true transform source -> target."""

    target: RobotMap
    source: RobotMap
    truth: Pose


def pair_of(target: RobotMap, source: RobotMap) -> Pair:
    """The pair with its true transform."""
    return Pair(target, source, target.start.inverse().compose(source.start))


class Surveyor:
    """Drives imaginary robots through a floor plan and draws their maps."""

    def __init__(self, plan: FloorPlan, clearance: float = 0.25) -> None:
        self.plan = plan
        self._wanderer = Wanderer(plan, clearance)

    def explore(
        self,
        random: np.random.Generator,
        survey: Survey,
        start: Optional[Tuple[float, float]] = None,
        yaw: Optional[float] = None,
    ) -> RobotMap:
        """Map of a robot that wanders from `start` (m, in the world; anywhere if None) for the survey's path length."""
        path = self._wanderer.path(random, survey, start)
        headings = np.unwrap(np.arctan2(*np.gradient(path, axis=0).T[::-1])) if len(path) > 1 else np.zeros(1)
        poses = np.column_stack([path, headings])
        if yaw is not None:
            poses[0, 2] = yaw
        return self.drawn(random, survey, poses)

    def drawn(self, random: np.random.Generator, survey: Survey, poses: np.ndarray) -> RobotMap:
        """Map of a robot that takes a scan at each of `poses` (n, 3; x, y, yaw in the world)."""
        begin = Pose(*(float(value) for value in poses[0]))
        error = _wandering_error(random, survey, len(poses))
        smudged = set(random.choice(len(poses), min(survey.smudges, len(poses)), replace=False).tolist())
        to_map = begin.inverse()
        lattice = random.uniform(-0.5, 0.5, 2).tolist()
        drawer = GridDrawer(info_around(to_map.apply(poses[:, :2]), survey.reach, survey.resolution, lattice))
        ends = [max(1, round(share * len(poses))) - 1 for share in survey.stages]
        stages: List[OccupancyGrid] = []
        for index, pose in enumerate(poses):
            walls = self._with_smudge(random, pose) if index in smudged else self.plan.walls
            ranges = cast(walls, self.plan.resolution, pose, survey)
            noise = random.normal(0.0, survey.range_noise, ranges.size)
            ranges = np.where(ranges < survey.reach, ranges + noise, ranges)
            seen = to_map.compose(Pose(*(float(value) for value in pose))).compose(error[index])
            drawer.add(seen, survey.angles(), ranges, survey.reach)
            if index in ends:
                stages.extend([drawer.grid()] * ends.count(index))
        return RobotMap(tuple(stages), begin, poses)

    def _with_smudge(self, random: np.random.Generator, pose: Sequence[float]) -> np.ndarray:
        walls = self.plan.walls.astype(np.uint8)
        angle = pose[2] + random.uniform(-1.5, 1.5)
        centre = np.asarray(pose[:2]) + random.uniform(0.8, 2.0) * np.array([math.cos(angle), math.sin(angle)])
        column, row = (round(value) for value in (centre / self.plan.resolution).tolist())
        cv2.circle(walls, (column, row), round(0.2 / self.plan.resolution), 1, -1)
        return walls.astype(bool)


def _wandering_error(random: np.random.Generator, survey: Survey, count: int) -> List[Pose]:
    if survey.drift == 0.0 or count < 2:
        return [Pose()] * count
    steps = random.normal(0.0, 1.0, (count, 3)) / math.sqrt(count) * (survey.drift, survey.drift, 0.2 * survey.drift)
    steps[0] = 0.0
    return [Pose(*(float(value) for value in row)) for row in steps.cumsum(axis=0)]
