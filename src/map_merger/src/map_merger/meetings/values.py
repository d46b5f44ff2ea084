"""What a robot tells the others so that they find it among what they see, and what its sensor saw."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple, Tuple

import numpy as np

from mr_grid import FARTHEST, Pose

from ..messages import NO_BOOT, Boot

MOST_POSES = 64
MOST_OBJECTS = 8
MOST_SAMPLES = 32
MOST_NAMES = 64
OLDEST_S = 30.0
"""Bounds of a report: poses, objects, places of each object, names, and the age of anything in it."""


class Sensor(NamedTuple):
    """What a robot can see: field of view (rad, symmetrical about straight ahead), shortest and longest range (m)."""

    view: float = 2.0 * math.pi
    nearest: float = 0.0
    farthest: float = 0.0


NO_SENSOR = Sensor()
"""Of a robot that does not look for others in scans: not seeing somebody proves nothing."""


UNMOVED = Pose()


def goes_round(beams: int, step: float) -> bool:
    """Whether beams that are `step` (rad) apart leave no gap, wherever the first one goes."""
    return (beams + 0.5) * abs(step) > 2.0 * math.pi


@dataclass(frozen=True, eq=False)
class LaserScan:
    """One sweep. ranges: float (n,), m, NaN or below `range_min` = invalid, `range_max` or above = nothing there.
    mount: the sensor in the robot's frame."""

    ranges: np.ndarray
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    mount: Pose = UNMOVED

    def __post_init__(self) -> None:
        numbers = (self.angle_min, self.angle_increment, self.range_min, self.range_max, *self.mount)
        if self.ranges.ndim != 1 or self.ranges.size < 3 or not all(math.isfinite(number) for number in numbers):
            raise ValueError("a scan needs at least 3 ranges and a finite geometry")
        if self.angle_increment == 0.0 or not self.range_max > 0.0:
            raise ValueError("a scan needs an angle between its beams and a longest range")

    @property
    def sensor(self) -> Sensor:
        """What can be seen with it."""
        span = abs(self.angle_increment) * (self.ranges.size - 1)
        last = self.angle_min + self.angle_increment * (self.ranges.size - 1)
        if goes_round(self.ranges.size, self.angle_increment):
            view = min(2.0 * math.pi, span)
        else:
            view = 2.0 * min(abs(self.angle_min), abs(last))
        return Sensor(view, max(0.0, self.range_min), self.range_max)


@dataclass(frozen=True, eq=False)
class ToldObject:
    """Something of a robot's size that the sender sees. samples: float (m, 3: age in s, x, y in m), oldest first, in
    the sender's map frame."""

    number: int
    samples: np.ndarray


@dataclass(frozen=True, eq=False)
class TrackReport:
    """Where a robot has been in the last seconds, in its map frame, and what it saw.

    boot: names the run. uptime: s since some moment of that run, of which only differences are used, to recognise the
    reports that came fastest. body_radius: m. poses: float (k, 4: age in s, x, y in m, yaw in rad), oldest first.
    unplaced: the robots it hears whose frame it does not know.
    """

    robot: str
    body_radius: float
    boot: Boot = NO_BOOT
    uptime: float = 0.0
    sensor: Sensor = NO_SENSOR
    poses: np.ndarray = field(default_factory=lambda: np.empty((0, 4)))
    objects: Tuple[ToldObject, ...] = ()
    unplaced: Tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """ValueError for what cannot be used."""
        if not self.robot:
            raise ValueError("a track without the name of its robot")
        if len(self.poses) > MOST_POSES or len(self.objects) > MOST_OBJECTS or len(self.unplaced) > MOST_NAMES:
            raise ValueError(f"a track of {self.robot!r} that is too long")
        _check(self.robot, np.asarray(self.poses, float).reshape(-1, 4))
        for each in self.objects:
            if len(each.samples) > MOST_SAMPLES:
                raise ValueError(f"a track of {self.robot!r} that is too long")
            _check(self.robot, np.asarray(each.samples, float).reshape(-1, 3))
        if not all(math.isfinite(number) for number in (self.uptime, *self.sensor)):
            raise ValueError(f"a track of {self.robot!r} with numbers that are not finite")
        if not 0.0 < self.body_radius < 10.0:
            raise ValueError(f"a track of {self.robot!r} with a body of {self.body_radius:g} m")


def _check(robot: str, rows: np.ndarray) -> None:
    if not np.isfinite(rows).all() or (np.abs(rows[:, 1:3]) > FARTHEST).any():
        raise ValueError(f"a track of {robot!r} with places that are not finite or above {FARTHEST:g} m")
    if ((rows[:, 0] < 0.0) | (rows[:, 0] > OLDEST_S)).any():
        raise ValueError(f"a track of {robot!r} with ages outside 0 to {OLDEST_S:g} s")


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """A transform of another robot's frame to the own one that the sightings suggest.

    covariance: float (3, 3) of (x, y, yaw), with the rotation about `centre`, a point of the other robot's frame (m).
    samples: sightings that agree. error: their root mean square distance, m. seconds: time they span. path: m over
    which something moved and was seen to. bend: m by which that path differs from a straight line; straight drives of
    equal speed are all alike. mutual: both robots saw the other. share: of what was seen of the objects that are taken
    for the other robot, the part that agrees. doubts: why it is not to be believed yet, '' if it is.
    """

    transform: Pose
    covariance: np.ndarray
    centre: Tuple[float, float]
    samples: int
    error: float
    seconds: float
    path: float
    bend: float
    mutual: bool
    share: float
    doubts: str = ""

    @property
    def settled(self) -> bool:
        """True if the sightings by themselves leave no doubt who it is."""
        return not self.doubts
