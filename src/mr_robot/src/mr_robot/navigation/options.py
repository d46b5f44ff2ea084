"""Options and values of the navigation engine. SI units, angles in radians, everything in the frame of the map."""

import math
from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np

from mr_grid import Pose
from mr_robot import _navigation

PROGRESS = _navigation.PROGRESS
LEAST_TURN = 0.3  # rad
# m within which robots, and what the map does not know, are in one another's way; no larger is what moves, and by no
# more does a way become another one.
REACH = 1.4
LONGEST_DETOUR = 5.0  # m that a robot goes out of its way, around what moves or to let it pass
STANDING = 2.5  # s without progress after which a robot does not get on as it is
CREEPING = PROGRESS / STANDING  # m/s
AT_REST = 8.0  # s after which what has not moved is taken to stay, and what was to come or pass is no longer waited for


class NavigationError(ValueError):
    """A parameter, map or goal that navigation cannot work with."""


@dataclass(frozen=True)
class NavigationOptions:
    """What has no default follows from the robot: `mr_robot.platforms.engines`."""

    max_linear_velocity: float  # m/s
    max_angular_velocity: float  # rad/s
    linear_acceleration: float  # m/s^2
    angular_acceleration: float  # rad/s^2
    footprint_length: float  # m, along the robot
    footprint_width: float
    largest_robot_radius: float  # m, from the centre of the largest robot of the team to its farthest corner
    inflation_radius: float  # m from walls within which paths cost more
    footprint_radius: float = 0.0  # m from its middle to its farthest point, half the length of a disc; 0 = a box
    obstacle_margin: float = 0.05  # m between footprint and what the laser sees
    moving_margin: float = 0.1  # m between footprint and what the map does not know, which may move
    moving_reaction_time: float = 0.25  # s of driving by which that margin grows
    xy_goal_tolerance: float = 0.15  # m
    yaw_goal_tolerance: float = 6.3  # rad; pi or more = any heading
    goal_search_radius: float = 0.5  # m around a goal in a wall or in the unknown within which another is taken
    allow_unknown: bool = False  # plan through cells never seen
    look_around: bool = True  # turn once on the spot before the first goal where the laser sees less than half a circle
    controller_period: float = 0.1  # s
    plan_period: float = 1.0  # s
    obstacle_memory: float = 4.0  # s an obstacle out of sight is remembered
    yield_patience: float = 1.0  # s a robot that has to give way waits before it does
    blocked_timeout: float = 25.0  # s a way may stay blocked or the robot stuck before the goal is given up

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.type is bool or field.type == "bool":
                continue
            if field.name == "footprint_radius" and value == 0:
                continue
            if not (np.isfinite(value) and value > 0):
                raise NavigationError(f"parameter {field.name} must be a positive number, not {value!r}")
        if not 0.001 <= self.controller_period <= 10.0:
            raise NavigationError(
                f"parameter controller_period must be from 0.001 to 10 s, not {self.controller_period:g}"
            )
        least = max(self.footprint_length, self.footprint_width) / 2.0
        if 0 < self.footprint_radius < least:
            raise NavigationError(
                f"parameter footprint_radius must be at least half the longer side, {least:g} m, or 0 for a box"
            )
        if self.inflation_radius <= self.inscribed_radius:
            raise NavigationError(
                f"parameter inflation_radius must exceed half the robot's width and margin, {self.inscribed_radius:g} m"
            )

    @property
    def half_width(self) -> float:
        """Nearest the robot's centre can come to a wall, m."""
        return min(self.footprint_length, self.footprint_width) / 2.0

    @property
    def inscribed_radius(self) -> float:
        """Nearest the robot's centre comes to a wall unless there is no other way."""
        return self.half_width + self.obstacle_margin

    @property
    def footprint(self) -> _navigation.Footprint:
        return _navigation.Footprint(self.footprint_length / 2.0, self.footprint_width / 2.0, self.footprint_radius)

    @property
    def circumscribed_radius(self) -> float:
        """Nearest a wall can be for the robot to turn beside it, m."""
        return self.footprint.radius

    @property
    def passing_distance(self) -> float:
        """Metres between the centres of this robot and another one from which on both can turn."""
        return round(self.circumscribed_radius + self.largest_robot_radius + 2.0 * self.moving_margin, 3)

    @property
    def ramp(self) -> float:
        """s between rest and full speed."""
        return max(
            self.max_linear_velocity / self.linear_acceleration, self.max_angular_velocity / self.angular_acceleration
        )

    @property
    def braking_time(self) -> float:
        """s from full speed to rest, with the period in which that is decided."""
        return self.ramp + self.controller_period

    @property
    def horizon(self) -> float:
        """s that local control looks ahead: a motion shows what it is worth at full speed, and has to end well."""
        return self.ramp + self.braking_time

    @property
    def reach(self) -> float:
        """Metres around the robot's centre in which obstacles bear on the next motion."""
        way = self.max_linear_velocity * (self.horizon + self.moving_reaction_time)
        return round(way + self.circumscribed_radius + 3.0 * self.moving_margin, 3)


@dataclass(frozen=True)
class Scan:
    """`points`: (n, 2) hits in the robot's frame; `ranges`: (m,), of all beams."""

    points: np.ndarray
    ranges: np.ndarray  # m, valid beams keep their reading, others are 0
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    mount: Pose

    @property
    def half_view(self) -> float:
        """rad to each side of where the laser looks."""
        return abs(0.5 * (len(self.ranges) - 1) * self.angle_increment)

    @property
    def middle(self) -> float:
        """rad from the robot's heading to where the laser looks."""
        return self.mount.yaw + self.angle_min + 0.5 * (len(self.ranges) - 1) * self.angle_increment

    def blind_to(self, points: np.ndarray) -> np.ndarray:
        """bool (n,), of points (n, 2) in the robot's frame: behind the robot, beside the field of view, or nearer than
        the sensor reads."""
        middle = self.angle_min + 0.5 * (len(self.ranges) - 1) * self.angle_increment
        from_laser = self.mount.apply_inverse(points)
        bearing = np.arctan2(from_laser[:, 1], from_laser[:, 0]) - middle
        beside = np.abs(np.remainder(bearing + math.pi, 2.0 * math.pi) - math.pi) > self.half_view
        near = np.hypot(*from_laser.T) < self.range_min
        blind: np.ndarray = (points[:, 0] < 0.0) | beside | near
        return blind


def make_scan(
    ranges: np.ndarray, angle_min: float, angle_increment: float, range_min: float, range_max: float, mount: Pose
) -> Scan:
    """`ranges`: m, (m,), of beams from `angle_min` on, rad; infinity = nothing hit. `mount`: the laser on the robot.
    Raises NavigationError for what would leave the robot blind."""
    beside = angle_increment != 0.0 or len(ranges) == 1
    if not all(map(math.isfinite, (range_min, angle_min, angle_increment))) or not beside:
        raise NavigationError(
            f"scan has an angle_min of {angle_min:g}, angle_increment of {angle_increment:g} and range_min of "
            f"{range_min:g}: they must be finite, and the increment of several beams not 0"
        )
    if not range_max > 0.0:
        raise NavigationError(f"range_max of the scan must be above 0, not {range_max:g}")
    directions = _directions(len(ranges), angle_min, angle_increment, mount[2])
    ranges, points = _navigation.hits(ranges, directions, range_min, range_max, mount[:2])
    return Scan(points, ranges, angle_min, angle_increment, range_min, range_max, mount)


@lru_cache(maxsize=16)
def _directions(count: int, angle_min: float, angle_increment: float, yaw: float) -> np.ndarray:
    """Unit vectors (count, 2) of the beams in the robot's frame."""
    angles = yaw + angle_min + angle_increment * np.arange(count)
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    directions.flags.writeable = False
    return directions
