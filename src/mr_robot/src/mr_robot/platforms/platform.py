"""The description of a kind of robot. SI units, angles in radians."""

import math
from dataclasses import dataclass, field

LEAST_GAP = 0.1  # rad; what is less beside a field of view hides nothing


class PlatformError(ValueError):
    """A description that cannot be used; the text names the culprit and what is expected."""


def rounded_up(length: float) -> float:
    """To 0.1 mm, so that nothing sticks out."""
    return math.ceil(1.0e4 * length - 1.0e-6) / 1.0e4


def looks_ahead(middle: float, field_of_view: float) -> bool:
    """Whether a sensor sees where a robot that drives ahead comes to; what is missing of a whole turn may lie there.
    `middle`: rad from the robot's heading to where it looks."""
    return abs(math.remainder(middle, 2.0 * math.pi)) <= field_of_view / 2.0 + LEAST_GAP


def looks_back(middle: float, field_of_view: float) -> bool:
    """Whether it sees where a robot that backs comes to, and not what is ahead."""
    return looks_ahead(middle + math.pi, field_of_view) and not looks_ahead(middle, field_of_view)


@dataclass(frozen=True)
class Footprint:
    """length, width: m, of the smallest box around the middle of the wheel axis that holds the robot. radius: m from
    there to its farthest corner."""

    length: float
    width: float
    radius: float

    @classmethod
    def box(cls, length: float, width: float) -> "Footprint":
        return cls(length, width, rounded_up(math.hypot(length, width) / 2.0))

    @classmethod
    def disc(cls, diameter: float) -> "Footprint":
        return cls(diameter, diameter, rounded_up(diameter / 2.0))

    @property
    def is_box(self) -> bool:
        """Whether it reaches into the corners of its box."""
        return self.radius >= Footprint.box(self.length, self.width).radius

    @property
    def half_width(self) -> float:
        """Nearest that a wall can come to the middle."""
        return min(self.length, self.width) / 2.0


@dataclass(frozen=True)
class RangeSensor:
    """A laser, or a camera whose depth is read as one. noise: m, standard deviation at any range; noise_share: standard
    deviation that comes on top, as a share of the range."""

    range_min: float
    range_max: float
    field_of_view: float
    noise: float
    noise_share: float = 0.0

    def noise_at(self, distance: float) -> float:
        """Standard deviation in m of a reading at that distance."""
        return math.hypot(self.noise, self.noise_share * distance)


@dataclass(frozen=True)
class Drive:
    """m/s, rad/s, m/s^2, rad/s^2."""

    max_linear_velocity: float
    max_angular_velocity: float
    linear_acceleration: float
    angular_acceleration: float


@dataclass(frozen=True)
class Frames:
    """Of tf, between which the drivers publish."""

    base: str = "base_footprint"
    odom: str = "odom"


@dataclass(frozen=True)
class Topics:
    """Of the drivers. The defaults are those of the simulated robot."""

    scan: str = "base_scan"
    odometry: str = "odom"
    velocity: str = "cmd_vel"


@dataclass(frozen=True)
class Mount:
    """Where the sensor is on the robot: x, y, z in m and yaw in rad from the base, and its frame."""

    frame: str = "base_laser_link"
    x: float = 0.0
    y: float = 0.0
    z: float = 0.3
    yaw: float = 0.0


@dataclass(frozen=True)
class Platform:
    """One kind of robot."""

    footprint: Footprint
    sensor: RangeSensor
    drive: Drive
    frames: Frames = field(default_factory=Frames)
    topics: Topics = field(default_factory=Topics)
    mount: Mount = field(default_factory=Mount)
