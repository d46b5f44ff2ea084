"""What a bag of a robot's mission holds: what the mission can be understood and replayed from."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Mapping, Sequence

SENSES = {"scan_topic": "base_scan", "odometry_topic": "odom", "velocity_topic": "cmd_vel"}
"""Topics of the drivers by parameter, with their names where nothing else is said."""
TOPICS = (
    "/clock", "/tf", "/tf_static", "base_pose_ground_truth",
    "map", "map_metadata", "map_merger/global_map", "map_merger/status", "all_positions",
    "map_other", "map_meta_other", "control", "position_other_robots",
    "map_merger/robot_track", "map_merger/transform_edges", "frontierPoints", "goalPoint/goalPoint",
    "frontiers", "visited_frontiers", "negotiation_list", "auction", "explorer/sent_auctions", "explorer/state",
    "explorer/status", "explorer/verdicts", "explorer/orders",
    "adhoc_communication/new_robot", "adhoc_communication/remove_robot", "adhoc_communication/status",
    "move_base/goal", "move_base/feedback", "move_base/result", "move_base/status",
)  # fmt: skip


def record_command(program: str, given: Mapping[str, Any], remappings: Sequence[str]) -> list[str]:
    """Command line of rosbag's recorder. `given`: parameters of the node, `output` an option that says where to; the
    recorder takes the node's name and renamed topics over with `remappings`. `disk_guard` looks at the disk in its
    place."""
    topics = [str(given.get(word) or name) for word, name in SENSES.items()]
    size = f"--size={int(given.get('bag_size', 300))}"
    options = ["--quiet", "--lz4", "--min-space=1M", "--buffsize=64", size, str(given["output"])]
    return [program, *options, *dict.fromkeys([*topics, *TOPICS]), *remappings]


def record_folder(given: Mapping[str, Any]) -> Path:
    """Where the bag comes to lie."""
    return Path(str(given["output"]).partition("=")[2]).absolute().parent
