"""Where the robots of the team are and have been, each in its own map frame."""

import math
from collections import deque
from typing import Deque, Dict, List, Mapping, NamedTuple, Optional, Tuple

import numpy as np

from mr_grid import Pose

from .places import thinned

TRACK_SPACING_M = 0.1
LONGEST_TRACK = 4000
POSE_PERIOD_S = 0.2
"""The own pose is taken at most as often."""
MOST_POSES = 80
"""Own poses of the last seconds that are kept."""


class Track:
    """Where and when a robot has been, in its own frame: points TRACK_SPACING_M apart, thinned out evenly when there
    are LONGEST_TRACK: the last one in each square."""

    def __init__(self) -> None:
        self._points = np.empty((0, 3))

    def add(self, x: float, y: float, time: float) -> bool:
        """Appends the place unless the robot has hardly moved; True if it was appended."""
        if len(self._points):
            last_x, last_y, _ = self._points[-1].tolist()
            if math.hypot(x - last_x, y - last_y) < TRACK_SPACING_M:
                return False
        self._points = np.concatenate([self._points, [(x, y, time)]])
        if len(self._points) > LONGEST_TRACK:
            self._points = self._points[thinned(self._points[:, :2], LONGEST_TRACK // 2, 2.0 * TRACK_SPACING_M)]
        return True

    def timed_points(self) -> np.ndarray:
        """Shape (n, 3): x and y in metres, time in seconds; oldest first. Not to be changed."""
        return self._points

    def points(self) -> np.ndarray:
        """Shape (n, 2), metres, oldest first."""
        return self.timed_points()[:, :2]


class HeardPose(NamedTuple):
    """A pose in the robot's frame and when it was heard (own clock, s)."""

    pose: Pose
    heard: float


class Place(NamedTuple):
    """Where a robot is in the own frame, metres."""

    robot: str
    x: float
    y: float


class Whereabouts:
    """Owns the poses and tracks of the own robot and of all others."""

    def __init__(self) -> None:
        self.own_pose: Optional[Pose] = None
        self.own_track = Track()
        self._own_poses: Deque[Tuple[float, Pose]] = deque(maxlen=MOST_POSES)
        self._positions: Dict[str, HeardPose] = {}
        self._tracks: Dict[str, Track] = {}

    def on_own_pose(self, pose: Pose, now: float) -> None:
        """The own robot's pose in the own map frame."""
        self.own_pose = pose
        self.own_track.add(pose.x, pose.y, now)
        self._own_poses.append((now, pose))

    def on_position(self, robot: str, pose: Pose, now: float) -> None:
        """A robot told its pose in its own map frame."""
        self._positions[robot] = HeardPose(pose, now)
        self._tracks.setdefault(robot, Track()).add(pose.x, pose.y, now)

    def forget(self, robot: str) -> None:
        """The robot's frame is a new one, or the robot is to be forgotten."""
        self._positions.pop(robot, None)
        self._tracks.pop(robot, None)

    def position(self, robot: str) -> Optional[HeardPose]:
        """The robot's last pose; None if none was heard."""
        return self._positions.get(robot)

    def track(self, robot: str) -> Track:
        """Where the robot has been, as far as it was heard."""
        return self._tracks.get(robot) or Track()

    def heard(self) -> Tuple[str, ...]:
        """The robots whose pose was heard."""
        return tuple(sorted(self._positions))

    def own_poses(self, now: float, longest: float) -> List[Pose]:
        """Own poses of the last `longest` seconds, oldest first."""
        return [pose for time, pose in self._own_poses if 0.0 <= now - time <= longest]

    def places(self, transforms: Mapping[str, Pose], now: float, longest: float) -> Tuple[Place, ...]:
        """In the own frame, those of `transforms` (to the own frame) that were heard in the last `longest` seconds."""
        return tuple(
            Place(name, *transform.apply_point(heard.pose.x, heard.pose.y))
            for name, transform in sorted(transforms.items())
            for heard in [self._positions.get(name)]
            if heard is not None and abs(now - heard.heard) <= longest
        )
