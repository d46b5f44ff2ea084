"""Parameters of nodes of other packages that may stand in for ours: SLAM of three of them, `move_base` of ROS and of
Move Base Flex."""

import math
from typing import Callable, Dict, List, Sequence

from mr_robot.platforms.parameters import Parameters, navigation_parameters
from mr_robot.platforms.platform import Platform

ROUND_CORNERS = 16  # of the polygon that stands for a round footprint


def gmapping_parameters(platform: Platform) -> Parameters:
    """Of `gmapping slam_gmapping`."""
    farthest = platform.sensor.range_max
    return {
        "base_frame": platform.frames.base,
        "odom_frame": platform.frames.odom,
        "maxUrange": round(farthest - 0.1, 3),
        "maxRange": farthest,
    }


def slam_toolbox_parameters(platform: Platform) -> Parameters:
    """Of `slam_toolbox async_slam_toolbox_node`."""
    return {
        "base_frame": platform.frames.base,
        "odom_frame": platform.frames.odom,
        "scan_topic": platform.topics.scan,
        "max_laser_range": platform.sensor.range_max,
    }


def hector_parameters(platform: Platform) -> Parameters:
    """Of `hector_mapping hector_mapping`."""
    return {
        "base_frame": platform.frames.base,
        "odom_frame": platform.frames.odom,
        "scan_topic": platform.topics.scan,
        "laser_min_dist": platform.sensor.range_min,
        "laser_max_dist": round(platform.sensor.range_max - 0.1, 3),
    }


SLAM_PARAMETERS: Dict[str, Callable[[Platform], Parameters]] = {
    "gmapping": gmapping_parameters,
    "slam_toolbox": slam_toolbox_parameters,
    "hector": hector_parameters,
}


def move_base_parameters(platform: Platform, team: Sequence[Platform]) -> Parameters:
    """Of `move_base move_base`, and of `mbf_costmap_nav`, which loads the same planner under the same name."""
    known = navigation_parameters(platform, team)
    inflation: float = known["inflation_radius"]
    planner = {
        "odom_topic": platform.topics.odometry,
        "max_vel_x": platform.drive.max_linear_velocity,
        "max_vel_theta": platform.drive.max_angular_velocity,
        "acc_lim_x": platform.drive.linear_acceleration,
        "acc_lim_theta": platform.drive.angular_acceleration,
    }
    if "yaw_goal_tolerance" in known:
        planner["yaw_goal_tolerance"] = known["yaw_goal_tolerance"]
    return {
        "global_costmap": _costmap(platform, inflation),
        "local_costmap": {"global_frame": platform.frames.odom, **_costmap(platform, round(inflation - 0.1, 3))},
        "TrajectoryPlannerROS": planner,
    }


def _costmap(platform: Platform, inflation: float) -> Parameters:
    return {
        "robot_base_frame": platform.frames.base,
        "footprint": _corners(platform),
        "obstacle_layer": {"scan": {"topic": platform.topics.scan}},
        "inflation_layer": {"inflation_radius": inflation},
    }


def _corners(platform: Platform) -> List[List[float]]:
    x, y, radius = platform.footprint.length / 2.0, platform.footprint.width / 2.0, platform.footprint.radius
    if platform.footprint.is_box:
        return [[-x, -y], [-x, y], [x, y], [x, -y]]
    around = radius / math.cos(math.pi / ROUND_CORNERS)  # a polygon around the circle
    angles = [2.0 * math.pi * (k + 0.5) / ROUND_CORNERS for k in range(ROUND_CORNERS)]
    corners = [(around * math.cos(angle), around * math.sin(angle)) for angle in angles]
    return [[round(min(max(a, -x), x), 4), round(min(max(b, -y), y), 4)] for a, b in corners]
