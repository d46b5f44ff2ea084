"""Descriptions of simulated robots, from the model of their world."""

import math
import re

from mr_robot.platforms.platform import (
    Drive,
    Footprint,
    Mount,
    Platform,
    PlatformError,
    RangeSensor,
    Topics,
    looks_back,
    rounded_up,
)
from mr_robot.platforms.preset import checked
from mr_sim.world_description import FEWEST_BEAMS, RangerDescription, RobotDescription

# m/s^2, rad/s^2 with which any robot is driven: the simulated ones have no bounds, as in Stage.
LINEAR_ACCELERATION, ANGULAR_ACCELERATION = 1.0, 3.14

_NAME = re.compile(r"(?!mc_)[A-Za-z0-9_.-]{1,64}")  # as adhoc_communication takes it


def name_fault(name: str) -> str:
    """Why no robot of a team can be called that, empty if one can."""
    if _NAME.fullmatch(name):
        return ""
    return "a name has 1 to 64 letters, digits, '_', '-' or '.', and does not begin with mc_ as those of groups do"


def platform_of(robot: RobotDescription) -> Platform:
    """Lengths to 0.1 mm; angles rounded down to 0.01 rad, so that nobody counts on more than there is. Of several
    rangers the main one counts. Raises PlatformError for a robot that cannot explore, in whatever host."""
    if name_fault(robot.name):
        raise PlatformError(f"{name_fault(robot.name)}: change it in the world file")
    if not robot.footprint:
        raise PlatformError("no body: give its model a size")
    if not robot.rangers:
        raise PlatformError("no laser: add a ranger to its position model")
    if robot.rangers[robot.main_ranger].samples < FEWEST_BEAMS:
        raise PlatformError(f"its rangers have less than {FEWEST_BEAMS} beams, as sonars: add a laser to its model")
    main = robot.rangers[robot.main_ranger]
    backs = looks_back(main.mount.yaw, main.field_of_view)
    linear = -robot.linear_bounds[0] if backs else robot.linear_bounds[1]
    angular = min(-robot.angular_bounds[0], robot.angular_bounds[1])
    if linear <= 0.0 or angular <= 0.0:
        way = "back, where alone it sees," if backs else "ahead"
        raise PlatformError(f"it cannot drive {way} and turn both ways: see velocity_bounds of its model")
    scan = Topics.scan if len(robot.rangers) == 1 else f"{Topics.scan}_{robot.main_ranger}"
    platform = Platform(
        _footprint(robot),
        _sensor(robot.rangers[robot.main_ranger]),
        Drive(linear, _rounded_down(angular), LINEAR_ACCELERATION, ANGULAR_ACCELERATION),
        topics=Topics(scan),
        mount=_mount(robot),
    )
    return checked(platform)


def _mount(robot: RobotDescription) -> Mount:
    frame = Mount.frame if len(robot.rangers) == 1 else f"{Mount.frame}_{robot.main_ranger}"
    x, y, yaw = (round(value, 4) for value in robot.rangers[robot.main_ranger].mount)
    return Mount(frame, x, y, yaw=yaw)


def _footprint(robot: RobotDescription) -> Footprint:
    corners = [corner for polygon in robot.footprint for corner in polygon]
    return Footprint(
        round(2.0 * max(abs(x) for x, _ in corners), 4),
        round(2.0 * max(abs(y) for _, y in corners), 4),
        rounded_up(max(math.hypot(x, y) for x, y in corners)),
    )


def _sensor(ranger: RangerDescription) -> RangeSensor:
    return RangeSensor(
        ranger.range_min,
        ranger.range_max,
        _rounded_down(ranger.field_of_view),
        round(math.sqrt(ranger.noise_variance), 4),
        round(ranger.noise_share / math.sqrt(3.0), 4),  # the world's errors are spread evenly up to their share
    )


def _rounded_down(angle: float) -> float:
    return math.floor(100.0 * angle + 1e-6) / 100.0
