"""Names of the parameters that the nodes of this package read."""

from dataclasses import fields

from mr_robot.navigation.options import NavigationOptions
from mr_robot.slam.engine import SlamOptions

FRAMES = {"map_frame", "odom_frame", "base_frame"}
SLAM = {field.name for field in fields(SlamOptions)} | FRAMES | {
    "map_update_interval", "transform_publish_period", "transform_tolerance", "scan_topic", "odometry_topic",
}  # fmt: skip
NAVIGATION = {field.name for field in fields(NavigationOptions)} | FRAMES | {
    "map_topic", "robot_name", "scan_topic", "velocity_topic",
}  # fmt: skip
