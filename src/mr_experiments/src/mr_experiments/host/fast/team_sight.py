"""What robots with perfect maps have seen and told, and who has found out where whose map lies."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Mapping

import cv2
import numpy as np

from map_merger.meetings.detection import FARTHEST_M
from mr_grid import Pose


@dataclass
class TeamSight:
    """Areas are polygons (n, 2). World frame, m.

    Kept for those that join late; a look from another place takes 3 kB.
    """

    starts: Mapping[str, Pose]
    areas: dict[str, list[np.ndarray]] = field(default_factory=dict)
    told: dict[str, int] = field(default_factory=dict)  # how many of its areas a robot has told the others
    poses: dict[str, Pose] = field(default_factory=dict)
    _groups: dict[str, set[str]] = field(default_factory=dict)

    def add(self, robot: str, area: np.ndarray, pose: Pose) -> None:
        """`area`: what is visible from `pose`."""
        self.areas.setdefault(robot, []).append(area)
        self.poses[robot] = pose

    def tell(self, robot: str) -> None:
        """The others get to know all that the robot has seen."""
        self.told[robot] = len(self.areas.get(robot, []))

    def told_areas(self, robot: str, first: int = 0) -> list[np.ndarray]:
        """From number `first` on."""
        return self.areas.get(robot, [])[first : self.told.get(robot, 0)]

    def sees(self, robot: str, other: str) -> bool:
        """As near as map_merger tells robots from what is around them."""
        if robot not in self.poses or other not in self.poses:
            return False
        (x, y), here = self.poses[other][:2], self.poses[robot][:2]
        if math.dist(here, (x, y)) > FARTHEST_M:
            return False
        return cv2.pointPolygonTest(self.areas[robot][-1].astype(np.float32), (float(x), float(y)), False) >= 0.0

    def link(self, one: str, other: str) -> None:
        """The transform between two robots is found, and told: it chains with those known before."""
        group = self.linked(one) | self.linked(other)
        self._groups.update((robot, group) for robot in group)

    def linked(self, robot: str) -> set[str]:
        """The robots whose maps the robot can place in its own, with itself."""
        return self._groups.get(robot, {robot})
