"""Robots that explore a generated floor by a simple rule, so that a map is there which grows as maps of a team do."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import cv2
import numpy as np

from explorer.grid import OccupancyMap
from explorer.travel import TravelGrid
from explorer.ways import COMFORT
from mr_grid import GridInfo, Pose
from mr_plans import anywhere, world_plan
from mr_robot.platforms.parameters import explorer_parameters, largest_radius
from mr_sim import _world
from mr_sim.simulated_platform import platform_of
from mr_sim.world_description import RobotDescription

BEAMS = 181  # that bound the visible area
BEHIND = 0.08  # m behind where a beam ends that are seen, which is the wall itself
APART = 6.0  # m that targets keep from those of other robots where they can


@dataclass
class _Driver:
    pose: Pose
    path: list[tuple[float, float]] = field(default_factory=list)


class ScriptedTeam:
    """Perfect maps of `robots` that drive through a plan of `mr_plans`, each to the nearest ground that nobody has
    seen, from starts all over the place. The map frame is the world's."""

    def __init__(self, kind: str, seed: int, size: tuple[float, float], robots: int, robot: RobotDescription) -> None:
        """`robot`: what all of them are."""
        plan, platform = world_plan(kind, seed, size), platform_of(robot)
        self._ranger = robot.rangers[robot.main_ranger]
        radius = explorer_parameters(platform, (platform,))["inflation_radius"]
        rows, columns = plan.walls.shape
        self.info = GridInfo(columns, rows, plan.resolution)
        self._truth = np.where(plan.walls, np.int8(100), np.int8(0))
        self._seen = np.zeros(plan.walls.shape, dtype=np.uint8)
        self._raster = _world.Raster(plan.walls.astype(np.uint8), plan.resolution, (0.0, 0.0))
        self._grid = TravelGrid(OccupancyMap(self.info, self._truth), radius, radius + COMFORT)
        self._drivers = [_Driver(Pose(*start)) for start in anywhere(plan, seed, largest_radius((platform,)), robots)]
        for driver in self._drivers:
            self._look(driver.pose)

    @property
    def poses(self) -> list[Pose]:
        return [driver.pose for driver in self._drivers]

    @property
    def known(self) -> float:
        """Share of the cells that have been seen."""
        return float(np.count_nonzero(self._seen)) / self._seen.size

    def map(self) -> OccupancyMap:
        return OccupancyMap(self.info, np.where(self._seen > 0, self._truth, np.int8(-1)))

    def drive(self, way: float) -> bool:
        """Each robot drives `way` metres and sees what there is to see at the end of it; False once all is seen."""
        before = self.poses
        for driver in self._drivers:
            self._advance(driver, way)
            self._look(driver.pose)
        return self.poses != before

    def _advance(self, driver: _Driver, way: float) -> None:
        if not driver.path:
            driver.path = self._next_path(driver)
        while driver.path and way > 0.0:
            (x, y), here = driver.path[0], driver.pose
            gap = math.hypot(x - here.x, y - here.y)
            part = 1.0 if gap <= way else way / gap
            yaw = math.atan2(y - here.y, x - here.x) if gap > 0.0 else here.yaw
            driver.pose = Pose(here.x + part * (x - here.x), here.y + part * (y - here.y), yaw)
            way -= part * gap
            if part == 1.0:
                driver.path.pop(0)

    def _next_path(self, driver: _Driver) -> list[tuple[float, float]]:
        """To the nearest ground not seen that no other robot drives to; none when all is seen."""
        costs = self._grid.field_from(driver.pose.x, driver.pose.y)
        info = self._grid.info
        seen = cv2.resize(self._seen, (info.width, info.height), interpolation=cv2.INTER_NEAREST) > 0
        left = np.argwhere(np.isfinite(costs.cost) & ~seen)
        if not len(left):
            return []
        ways = costs.cost[left[:, 0], left[:, 1]]
        places = info.centres_of(left)
        for other in self._drivers:
            if other is not driver and other.path:
                ways = ways + np.where(np.hypot(*(places - other.path[-1]).T) < APART, 1e3, 0.0)
        return costs.path_to(*places[int(np.argmin(ways))].tolist())[1:]

    def _look(self, pose: Pose) -> None:
        view, farthest = self._ranger.field_of_view, self._ranger.range_max
        angles = pose.yaw + np.linspace(-0.5 * view, 0.5 * view, BEAMS)
        lengths = self._raster.cast((pose.x, pose.y), angles, farthest)
        reach = np.where(lengths < farthest, lengths + BEHIND, lengths)[:, None]
        ends = np.array((pose.x, pose.y)) + reach * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        area = np.concatenate([[(pose.x, pose.y)], ends])
        cv2.fillPoly(self._seen, [np.floor(area / self.info.resolution).astype(np.int32)], 1)
