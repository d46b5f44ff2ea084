"""All that is known about one other robot."""

import math
from typing import NamedTuple, Optional

import numpy as np

from .alignment import Alignment
from .sighting import Views
from .transform import Transform

TRACK_SPACING_M = 0.1
LONGEST_TRACK = 4000


class Track:
    """Where and when a robot has been, in its own frame: points TRACK_SPACING_M apart, thinned out when there are
    LONGEST_TRACK."""

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
            self._points = self._points[::2].copy()
        return True

    def timed_points(self) -> np.ndarray:
        """Shape (n, 3): x and y in metres, time in seconds; oldest first. Not to be changed."""
        return self._points

    def points(self) -> np.ndarray:
        """Shape (n, 2), metres, oldest first."""
        return self.timed_points()[:, :2]


class HeardPose(NamedTuple):
    """A pose in the robot's frame and when it was heard (own clock, s)."""

    pose: Transform
    heard: float


class Peer:
    """Another robot: its transform, its track, and what was seen of it. Its map is the exchange's."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.alignment = Alignment()
        self.track = Track()
        self.position: Optional[HeardPose] = None
        self.seen = Views()
        """What own maps showed where the robot was."""
        self.saw = Views()
        """What the robot's map showed where the own robot was."""
        self.viewed = -1
        """Version of the robot's map that was looked at last, and when (own clock, s)."""
        self.viewed_at = -math.inf
        self.run = 0
        """Run of the robot (Exchange.run_of) whose frame all this is about."""
        self.version = 0
        """Version of the robot's map (Exchange.version_of) that was taken over last."""
        self.generation = 0

    def restart(self) -> None:
        """The robot's frame is a new one."""
        self.forget_transform()
        self.track = Track()
        self.position = None

    def forget_transform(self) -> None:
        """The robot's frame or the own one is a new one: nothing that was found out between them holds."""
        self.alignment.forget()
        self.forget_sightings()
        self.generation += 1

    def forget_sightings(self) -> None:
        """What was seen so far does not count."""
        self.seen, self.saw, self.viewed = Views(), Views(), -1
