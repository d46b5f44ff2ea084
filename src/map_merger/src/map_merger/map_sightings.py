"""Views of maps from the times at which it was known where a robot was: what sightings are found in later."""

import math
from dataclasses import dataclass, field
from typing import Dict, Optional, Sequence, Tuple

from mr_grid import OccupancyGrid, Pose

from .sighting import LONGEST_LAG_S, Sighting, View, Views, view_of
from .whereabouts import HeardPose

SHORTEST_VIEW_S = 1.0
"""Another robot's map, which comes in parts, is looked at this often for the own robot."""


@dataclass
class _Kept:
    """Of one other robot."""

    seen: Views = field(default_factory=Views)
    """What own maps showed where the robot was."""
    saw: Views = field(default_factory=Views)
    """What the robot's map showed where the own robot was."""
    version: int = -1
    """Version of the robot's map that was looked at last, and when (own clock, s)."""
    looked_at: float = -math.inf


class MapSightings:
    """Owns the views of own maps in which others may be seen, and of others' maps in which the own robot may be."""

    def __init__(self) -> None:
        self._kept: Dict[str, _Kept] = {}
        self._map: Optional[OccupancyGrid] = None
        self._map_time = -math.inf
        self._view: Optional[View] = None

    def on_map(self, grid: OccupancyGrid, now: float) -> None:
        """The own map changed."""
        self._map, self._map_time, self._view = grid, now, None

    def look_for(self, robot: str, position: Optional[HeardPose], viewer: Optional[Pose], now: float) -> None:
        """Keeps what the own map, whose robot is at `viewer`, shows while it is known where the other robot is."""
        if position is None or self._map is None:
            return
        if max(abs(now - position.heard), abs(now - self._map_time)) <= LONGEST_LAG_S:
            self._view = self._view or view_of(self._map, viewer)
            self._of(robot).seen.add(Sighting(self._view, position.pose.x, position.pose.y, now))

    def look_through(
        self,
        robot: str,
        grid: OccupancyGrid,
        version: int,
        position: Optional[HeardPose],
        own_poses: Sequence[Pose],
        now: float,
    ) -> None:
        """Keeps what the other robot's map shows together with the places where the own robot was just before."""
        kept = self._of(robot)
        if kept.version == version or 0.0 <= now - kept.looked_at < SHORTEST_VIEW_S:
            return
        kept.version, kept.looked_at = version, now
        view = view_of(grid, None if position is None else position.pose)
        for pose in own_poses:
            kept.saw.add(Sighting(view, pose.x, pose.y, now))

    def of(self, robot: str) -> Tuple[Tuple[Sighting, ...], Tuple[Sighting, ...]]:
        """(what own maps showed where the robot was, what its maps showed where the own robot was)."""
        kept = self._of(robot)
        return kept.seen.all(), kept.saw.all()

    def forget(self, robot: str) -> None:
        """What was seen of the robot so far does not count."""
        self._kept.pop(robot, None)

    def forget_all(self) -> None:
        """The own frame is a new one."""
        self._kept.clear()
        self._map, self._view = None, None

    def _of(self, robot: str) -> _Kept:
        if robot not in self._kept:
            self._kept[robot] = _Kept()
        return self._kept[robot]
