"""What is around the robot beside the walls of its map: what its laser sees and has seen, and robots that say where
they are."""

import math
from typing import List, Mapping, Optional

import numpy as np

from mr_grid import Pose, is_place
from mr_robot import _navigation
from mr_robot.navigation.command import Velocity
from mr_robot.navigation.obstacles import KNOWN_WITHIN, ObstacleMemory
from mr_robot.navigation.options import NavigationOptions, Scan
from mr_robot.navigation.planner import CostMap
from mr_robot.navigation.yielding import Point, nearest_blocker

WALL_MARGIN = 0.02  # m to walls known from the map alone: their cells are coarse
POINT_SPACING = 0.03  # m, finer detail of obstacles does not matter
ROBOT_NEAR = 1.5  # m within which a robot that says where it is counts where the laser is blind
ROBOT_RIM = 0.04  # m by which the rim that its footprint takes up lies within the radius of the largest robot
HINT_AGE = 6.0  # s for which reported positions of other robots count
BUMPED = 0.03  # m before the side that ran into what the laser does not see, where it is taken to be
# Unit vectors (12, 2) all around, for the rim of a robot.
CIRCLE = np.stack([np.cos(np.arange(12) * math.pi / 6.0), np.sin(np.arange(12) * math.pi / 6.0)], axis=1)


class Surroundings:
    def __init__(self, options: NavigationOptions, name: str) -> None:
        """`name`: of this robot, whose own position is no other's."""
        self._options = options
        self._name = name
        self._memory = ObstacleMemory(options.obstacle_memory)
        self._others: Mapping[str, Point] = {}
        self._others_at = -math.inf
        self._hits = np.empty((0, 2))  # of the latest scan, robot's frame
        self._near = options.reach_in(_navigation.Horizon().duration)
        self._rim = round(options.largest_robot_radius - ROBOT_RIM, 3)
        self._margins = _navigation.Margins(
            WALL_MARGIN, options.obstacle_margin, options.moving_margin, options.moving_reaction_time
        )

    def set_others(self, positions: Mapping[str, Point], now: float) -> List[str]:
        """The names of those whose position cannot be and is ignored."""
        usable = {name: position for name, position in positions.items() if is_place(*position)}
        self._others = {name: position for name, position in usable.items() if name != self._name}
        self._others_at = now
        return sorted(set(positions) - set(usable))

    @property
    def robots(self) -> List[Point]:
        """Where others said last that they are, however long ago."""
        return list(self._others.values())

    def others(self, now: float) -> Mapping[str, Point]:
        """Those who said so lately."""
        return self._others if now - self._others_at < HINT_AGE else {}

    def see(self, scan: Scan, pose: Pose, costs: CostMap, now: float) -> None:
        self._hits = scan.points
        self._memory.update(scan, pose, costs.walls, now)

    def bump(self, pose: Pose, velocity: Velocity, now: float) -> None:
        """Remembers points along the side that ran into something that the laser does not see."""
        if velocity[0] == 0.0:
            return
        x = math.copysign(self._options.footprint_length / 2.0 + BUMPED, velocity[0])
        half = self._options.footprint_width / 2.0
        self._memory.add(pose.apply(np.array([(x, y) for y in np.linspace(-half, half, 9)])), now)

    def obstacles(self, costs: CostMap, pose: Pose, scan: Scan) -> np.ndarray:
        """What the next motion must not touch: rows (x, y, margin, reaction time) in the map frame."""
        return _navigation.surroundings(
            scan.points, pose, self._memory.rows, costs.walls, self._margins, KNOWN_WITHIN, self._near, POINT_SPACING,
            scan.ranges, scan.angle_min, scan.angle_increment, scan.mount,
        )  # fmt: skip

    def unseen_robots(self, now: float, pose: Pose, scan: Scan) -> np.ndarray:
        """Rows as `obstacles`: behind, and wherever else the laser is blind, the rims of robots that say they are
        there."""
        near = [place for place in self.others(now).values() if math.dist(place, pose[:2]) < ROBOT_NEAR]
        if not near:
            return np.empty((0, 4))
        places = np.array(near)
        unseen = places[scan.blind_to(pose.apply_inverse(places))]
        rims = (unseen[:, None, :] + self._rim * CIRCLE[None, :, :]).reshape(-1, 2)
        margins = np.tile([self._options.moving_margin, self._options.moving_reaction_time], (len(rims), 1))
        return np.hstack([rims, margins])

    def moving_points(self, pose: Pose) -> np.ndarray:
        """Remembered obstacles (n, 2) but for what lies inside the robot itself."""
        points = self._memory.points
        return points[np.hypot(points[:, 0] - pose[0], points[:, 1] - pose[1]) > self._options.inscribed_radius]

    def blocker(self, pose: Pose, closed: bool) -> Optional[Point]:
        """What moves ahead of the robot, or, on a way that `closed` after it was planned, whatever is ahead."""
        points = self._memory.points
        if closed and not self._memory.size:
            points = np.concatenate([points, pose.apply(self._hits)])
        return nearest_blocker(points, pose)
