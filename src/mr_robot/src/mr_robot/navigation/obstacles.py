"""What the laser has seen lately and the map does not know: doors, people, other robots."""

import numpy as np

from mr_grid import Pose
from mr_robot import _navigation
from mr_robot.navigation.options import Scan

REMEMBERED_LIMIT = 2000


class ObstacleMemory:
    """Points (x, y, time seen) in the map frame. Bounded: the oldest go first."""

    def __init__(self, duration: float) -> None:
        """`duration`: s for which a point out of sight is remembered."""
        self._duration = duration
        self.clear()

    @property
    def rows(self) -> np.ndarray:
        """float64 (n, 3): x and y in m, map frame; s when seen."""
        return self._rows

    @property
    def points(self) -> np.ndarray:
        """(n, 2), map frame."""
        return self._rows[:, :2]

    @property
    def size(self) -> int:
        return len(self._rows)

    def clear(self) -> None:
        self._rows = np.empty((0, 3))

    def add(self, points: np.ndarray, now: float) -> None:
        """Points (n, 2) known from elsewhere than the laser."""
        self._rows = np.vstack([self._rows, np.column_stack([points, np.full(len(points), now)])])

    def update(self, scan: Scan, pose: Pose, walls: _navigation.Walls, now: float) -> None:
        """`walls`: of the map; hits at them are not remembered, and of others one in each of its cells."""
        rule = _navigation.Memory(self._duration, walls.resolution, REMEMBERED_LIMIT)
        self._rows = _navigation.remember(
            self._rows, scan.points, scan.ranges, scan.angle_min, scan.angle_increment, scan.range_min, scan.mount,
            pose, walls, rule, now,
        )  # fmt: skip
