"""Names of the parameters that the nodes of this package read."""

from dataclasses import fields

from mr_robot.navigation.options import NavigationOptions
from mr_robot.slam.options import SlamOptions

# With what they are where nobody says.
FRAMES = {"map_frame": "map", "odom_frame": "odom", "base_frame": "base_footprint"}
SLAM_INPUTS = {"scan_topic": "base_scan", "odometry_topic": "odom"}
DRIVERS = {"scan_topic": "base_scan", "velocity_topic": "cmd_vel"}  # of navigation

SLAM = {
    *(field.name for field in fields(SlamOptions)), *FRAMES, *SLAM_INPUTS,
    "map_update_interval", "transform_publish_period", "transform_tolerance", "memory",
}  # fmt: skip
NAVIGATION = {*(field.name for field in fields(NavigationOptions)), *FRAMES, *DRIVERS, "map_topic", "robot_name"}
