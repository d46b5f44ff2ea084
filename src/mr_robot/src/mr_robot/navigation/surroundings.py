"""What is around the robot beside the walls of its map: what its laser sees and has seen."""

import math
from typing import Callable, NamedTuple, Optional

import numpy as np

from mr_grid import Pose
from mr_robot import _navigation
from mr_robot.navigation.command import Velocity
from mr_robot.navigation.obstacles import ObstacleMemory
from mr_robot.navigation.options import NavigationOptions, Scan
from mr_robot.navigation.planner import CostMap
from mr_robot.navigation.yielding import Point, nearest_blocker
from mr_robot.platforms.parameters import NARROW_VIEW

APPROACH = 0.2  # m/s at which what was seen behind the robot and may move is taken to come


class Hazards(NamedTuple):
    """Rows (x, y, margin, reaction time) in the map frame."""

    obstacles: np.ndarray
    followers: Callable[[], np.ndarray]  # what may have come nearer behind the robot; only manoeuvres ask


class Surroundings:
    def __init__(self, options: NavigationOptions) -> None:
        self._options = options
        self._memory = ObstacleMemory(options.obstacle_memory)
        self._hits = np.empty((0, 2))  # of the latest scan, robot's frame
        self._footprint = options.footprint
        self._near = options.reach

    def see(self, scan: Scan, pose: Pose, costs: CostMap, now: float) -> None:
        self._hits = scan.points
        self._memory.update(scan, pose, costs.walls, now)

    def bump(self, pose: Pose, velocity: Velocity, now: float) -> None:
        """Remembers points just before the side that ran into something that the laser does not see."""
        if velocity[0] == 0.0:
            return
        x = math.copysign(self._options.footprint_length / 2.0 + _navigation.TOUCHING, velocity[0])
        half = self._options.footprint_width / 2.0
        self._memory.add(pose.apply(np.array([(x, y) for y in np.linspace(-half, half, 9)])), now)

    def obstacles(self, costs: CostMap, own: Optional[_navigation.Map], pose: Pose, scan: Scan) -> np.ndarray:
        """What the next motion must not touch: rows (x, y, margin, reaction time) in the map frame. `own`: what the
        robot itself has mapped, in the same frame."""
        options = self._options
        # Cells are coarse, so walls known from the map alone may be closer; a robot that sees little has not much else.
        wall_margin = _navigation.TOUCHING if 2.0 * scan.half_view >= NARROW_VIEW else options.obstacle_margin
        margins = _navigation.Margins(
            wall_margin, options.moving_margin, options.obstacle_margin, options.moving_margin,
            options.moving_reaction_time,
        )  # fmt: skip
        return _navigation.surroundings(
            scan.points, pose, self._memory.rows, costs.walls, own, self._footprint, margins, self._near,
            scan.ranges, scan.angle_min, scan.angle_increment, scan.mount,
        )  # fmt: skip

    def followers(self, now: float, costs: CostMap, pose: Pose) -> np.ndarray:
        """Rows (x, y, margin, reaction time), map frame, of what the robot saw on free ground behind it, where it is
        blind: it may have come nearer since."""
        rows = self._memory.rows
        places = pose.apply_inverse(rows[:, :2])
        behind = (places[:, 0] < -self._footprint.half_length) & (np.hypot(*places.T) < self._near)
        rows = rows[behind]
        rows = rows[costs.is_open(rows[:, :2], costs.walls.same_surface)]
        margins = self._options.moving_margin + APPROACH * (now - rows[:, 2])
        return np.column_stack([rows[:, :2], margins, np.full(len(rows), self._options.moving_reaction_time)])

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
