"""What follows from the description of a robot, and of the largest in its team, for the parameters of each node.

Lengths are those of the robot and a margin for what maps, poses and wheels are off, so they are sums and no products.
`team`: the kinds of robots in the team, with the robot's own.
"""

from typing import Any, Dict, Sequence

from mr_robot.platforms.platform import Platform

Parameters = Dict[str, Any]
"""Private parameters of one node: name -> value."""

VIEW_SHARE = 0.5  # of a sensor's range from which a frontier is looked at: beyond, noise and gaps between beams grow
FARTHEST_VIEW = 1.5  # m from which one is looked at
NARROW_VIEW = 3.0  # rad; a robot with a narrower one has to face what it was sent to look at
YAW_TOLERANCE = 0.25  # rad to which it does
FREE_RANGE = 20.0  # m that a beam frees at most where it hits nothing
SURFACE_ROUGHNESS = 0.01  # m that hits lie off a wall's surface beside the sensor's noise: cells, and walls themselves


def slam_parameters(platform: Platform, team: Sequence[Platform]) -> Parameters:
    """Of `mr_robot slam`."""
    noise = platform.sensor.noise_at(VIEW_SHARE * platform.sensor.range_max)
    half_width = platform.footprint.half_width
    return {
        "base_frame": platform.frames.base,
        "odom_frame": platform.frames.odom,
        "scan_topic": platform.topics.scan,
        "odometry_topic": platform.topics.odometry,
        "surface_deviation": round(noise + SURFACE_ROUGHNESS, 3),
        "free_radius": _length(max(half_width - 0.02, 0.5 * half_width)),
        "free_range": min(FREE_RANGE, platform.sensor.range_max),
        "small_object_size": _length(2.0 * largest_radius(team) + 0.12),
    }


def navigation_parameters(platform: Platform, team: Sequence[Platform]) -> Parameters:
    """Of `mr_robot move_base`."""
    drive, footprint = platform.drive, platform.footprint
    parameters = {
        "base_frame": platform.frames.base,
        "odom_frame": platform.frames.odom,
        "scan_topic": platform.topics.scan,
        "velocity_topic": platform.topics.velocity,
        "max_linear_velocity": drive.max_linear_velocity,
        "max_angular_velocity": drive.max_angular_velocity,
        "linear_acceleration": drive.linear_acceleration,
        "angular_acceleration": drive.angular_acceleration,
        "footprint_length": footprint.length,
        "footprint_width": footprint.width,
        "largest_robot_radius": largest_radius(team),
        "inflation_radius": _length(footprint.half_width + 0.41),
    }
    if not footprint.is_box:
        parameters["footprint_radius"] = footprint.radius
    if platform.sensor.field_of_view < NARROW_VIEW:
        parameters["yaw_goal_tolerance"] = YAW_TOLERANCE
    return parameters


def explorer_parameters(platform: Platform, team: Sequence[Platform]) -> Parameters:
    """Of `explorer`."""
    sensor = platform.sensor
    return {
        "base_link": platform.frames.base,
        "inflation_radius": _length(platform.footprint.half_width + 0.06),
        "largest_robot_radius": largest_radius(team),
        "field_of_view": sensor.field_of_view,
        "view_distance": min(FARTHEST_VIEW, _length(VIEW_SHARE * sensor.range_max)),
    }


def merger_parameters(platform: Platform, team: Sequence[Platform]) -> Parameters:
    """Of `map_merger`. The body that it looks for is any of the team's, so it takes the mean of their kinds."""
    depths = [each.footprint.half_width + 0.01 for each in team]
    return {
        "scan_topic": platform.topics.scan,
        "position_local_robot_topic": platform.topics.odometry,
        "body_radius": round(sum(depths) / len(depths), 2),
        "largest_robot_radius": largest_radius(team),
    }


def largest_radius(team: Sequence[Platform]) -> float:
    """m, from the centre of the largest robot of the team to its farthest corner."""
    return round(max(each.footprint.radius for each in team), 2)


def kinds_of(team: Sequence[Platform]) -> Sequence[Platform]:
    """Each kind of robot in the team once."""
    return tuple(dict.fromkeys(team))


def _length(metres: float) -> float:
    return round(metres, 3)
