"""Topics and frames of a real robot's drivers, where its launch file was given other ones than the preset's."""

from __future__ import annotations

from typing import Any, Iterable, Mapping

from mr_launch.recordings.bags import decoded, messages, topic_of

SCAN = "sensor_msgs/msg/LaserScan"
KINDS = {"scan": SCAN, "odometry": "nav_msgs/msg/Odometry", "velocity": "geometry_msgs/msg/Twist"}
TRUTH = "base_pose_ground_truth"  # odometry, but of no driver


def topics_of_kind(connections: Iterable[Any], purpose: str) -> list[str]:
    """Those that may be the driver's."""
    found = {topic_of(connection) for connection in connections if connection.msgtype == KINDS[purpose]}
    return sorted(found - {TRUTH})


def driver_arguments(connections: Iterable[Any], preset: Mapping[str, str]) -> dict[str, str]:
    """As of replayed_robot.launch: where the bags do not have the preset's topic but exactly one other of its kind.
    `preset`: names of topics by what they are for."""
    arguments = {}
    for purpose in KINDS:
        names = topics_of_kind(connections, purpose)
        if len(names) == 1 and names != [preset[purpose].strip("/")]:
            arguments[f"{purpose}_topic"] = names[0]
    return arguments


def frame_arguments(reader: Any, odometry: str, preset: Mapping[str, str]) -> dict[str, str]:
    """As of replayed_robot.launch: those that the odometry names, where it names others than the preset. `odometry`:
    its topic; `preset`: frames by what they are of."""
    there = [connection for connection in reader.connections if topic_of(connection) == odometry.strip("/")]
    there = [connection for connection in there if connection.msgtype == KINDS["odometry"]]
    for connection, _, octets in messages(reader, there):
        message = decoded(reader, connection, octets)
        if message is not None:
            named = {"odom": message.header.frame_id.lstrip("/"), "base": message.child_frame_id.lstrip("/")}
            return {f"{word}_frame": frame for word, frame in named.items() if frame and frame != preset[word]}
    return {}


def scan_note(robot: str, connections: Iterable[Any], preset: Mapping[str, str]) -> str:
    """What is to be said where it cannot be told which scans are to be used; empty if it can."""
    names = topics_of_kind(connections, "scan")
    if len(names) == 1 or preset["scan"].strip("/") in names:
        return ""
    there = f"only on {', '.join(names)}" if names else "on no topic"
    return f"the bags of {robot} have no scans on {preset['scan']}, {there}; is --robot right?"
