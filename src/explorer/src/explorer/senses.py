"""What the robot itself tells: its map, its pose, and when they last changed."""

import math
from typing import Optional

from explorer.geometry import apart, turn
from explorer.grid import OccupancyMap
from mr_grid import Pose

MAP_DELAY = 1.5  # s that a map is taken to be behind what is seen where the robot's SLAM does not tell of its maps
NOTHING_TIME = 5.0  # s at rest after which a map that does not change counts as fresh


class Senses:
    """Map, pose and home outlive a mission; times and the way driven belong to one. `home`: None until the robot has a
    pose, and for good where it `is_lost`. `shown`: time in seconds up to which the map shows what the robot has seen:
    that of the last map of its own SLAM that came before."""

    def __init__(self, home: Optional[Pose]) -> None:
        self.map: Optional[OccupancyMap] = None
        self.pose: Optional[Pose] = None
        self.home = home
        self.home_is_lost = False
        self.restart()

    def restart(self) -> None:
        """Forgets all times."""
        self.maps = 0
        self.distance = 0.0  # m
        self.map_time = self.shown = -math.inf
        self._own_map_time = -math.inf
        self._motion_time = -math.inf
        self._motion_pose: Optional[Pose] = None

    def begin_frame(self, shift: Optional[Pose]) -> None:
        """The map frame is another one; `shift`: the former one in it, None where nothing ties them."""
        if self.home is not None:
            self.home = None if shift is None else shift.compose(self.home)
            self.home_is_lost = self.home is None
        self.map = self.pose = self._motion_pose = None
        self.map_time = self.shown = self._own_map_time = self._motion_time = -math.inf

    def take_map(self, occupancy: OccupancyMap, now: float) -> None:
        self.map, self.map_time = occupancy, now
        self.shown = self._own_map_time if math.isfinite(self._own_map_time) else now - MAP_DELAY
        self.maps += 1

    def take_own_map(self, now: float) -> None:
        """The robot's own SLAM has updated its map."""
        self._own_map_time = now

    def take_pose(self, pose: Pose, now: float) -> None:
        if self.pose is not None:
            step = apart(self.pose, pose)
            self.distance += step if step > 0.005 else 0.0
        self.pose = pose
        if self.home is None and not self.home_is_lost:
            self.home = pose
        anchor = self._motion_pose
        if anchor is None or apart(anchor, pose) > 0.05 or abs(turn(anchor.yaw, pose.yaw)) > 0.1:
            self._motion_pose, self._motion_time = pose, now

    def rests(self, now: float) -> bool:
        """The robot has stood for so long that the map shows all that there is to see from here."""
        return now - self._motion_time >= NOTHING_TIME

    def fresh(self, now: float) -> bool:
        """Both maps are younger than the last motion, or no longer change."""
        return min(self.map_time, self._own_map_time) > self._motion_time or self.rests(now)
