"""How a robot is set up, from the parameters on its master. Knows names of parameters, and no ROS."""

from __future__ import annotations

import math
from typing import Any, Callable, Iterable, Iterator

from explorer import options as explorer_options
from map_merger import options as merger_options
from mr_grid.parameter_names import unknown_parameters
from mr_launch.doctor.facts import FRAME_SIZE, SetUp, Topic
from mr_launch.node_options import Parameters, explorer_fault, merger_fault
from mr_robot import parameter_names
from mr_robot.navigation.options import NavigationError, NavigationOptions
from mr_robot.platforms.engines import defaults_of

NODES = (
    "adhoc_communication",
    "map_merger",
    "explorer",
    "slam",
    "move_base",
    "mission_control",
    "velocity_override",
)
"""Of robot.launch."""
BODY = "robot"
"""The node of mr_sim that simulates one."""
RECORDER = "bag"
"""The node of recorder.launch."""
WITH_A_BODY = {"map_merger", "explorer", "slam", "move_base"}
"""Those that need scans and odometry; adhoc.launch alone has none of them."""


def set_up_of(given: Parameters) -> SetUp:
    """`given`: all parameters of the robot's namespace, nested."""
    nodes = tuple(node for node in NODES if isinstance(given.get(node), dict))
    simulator = parameters_of(given, BODY)
    merger, explorer, slam, navigation = (
        parameters_of(given, node) for node in ("map_merger", "explorer", "slam", "move_base")
    )
    named = [node for node in nodes if "robot_name" in given[node]]
    faults = {node: tuple(check(given[node])) for node, check in _CHECKS.items() if node in nodes}
    faults.update({node: (f"holds no parameters, but {given[node]!r:.60}",) for node in _scalars(given)})
    return SetUp(
        nodes,
        BODY if "socket" in simulator else "",  # a node of another launch file may have the name
        RECORDER if "output" in parameters_of(given, RECORDER) else "",
        {node: str(given[node]["robot_name"]) for node in named},
        {node: found for node, found in faults.items() if found},
        map_frame=_first([merger.get("local_map_frame_id")], "map"),
        odom_frame=_first([slam.get("odom_frame"), navigation.get("odom_frame")], "odom"),
        base_frame=_first(
            [slam.get("base_frame"), navigation.get("base_frame"), explorer.get("base_link")], "base_link"
        ),
        has_body=merger.get("has_local_map") is not False and bool(set(nodes) & WITH_A_BODY),
    )


def parameters_of(given: Parameters, node: str) -> Parameters:
    """Those of one node; none where something else has its name."""
    found = given.get(node)
    return found if isinstance(found, dict) else {}


def _scalars(given: Parameters) -> list[str]:
    """Nodes whose name has one value in place of parameters."""
    return [node for node in NODES if node in given and not isinstance(given[node], dict)]


def frame_size_of(radio: Parameters) -> int | None:
    """Octets that adhoc_communication is told to send; None for what is no number."""
    size = radio.get("max_frame_size", FRAME_SIZE)
    is_number = isinstance(size, (int, float)) and not isinstance(size, bool) and math.isfinite(size)
    return int(size) if is_number else None


def _first(values: Iterable[Any], default: str) -> str:
    return next((str(value).strip("/") for value in values if value), default)


def topics_of(given: Parameters) -> dict[str, Topic]:
    """The topics that the robot lives on, by what they are for, with names as the nodes have them."""
    nodes = ("map_merger", "slam", "move_base", "velocity_override")
    merger, slam, navigation, override = (parameters_of(given, node) for node in nodes)
    names = {
        "scan": slam.get("scan_topic") or merger.get("scan_topic") or "base_scan",
        "odometry": slam.get("odometry_topic") or merger.get("position_local_robot_topic") or "odom",
        "velocity": override.get("velocity_topic") or navigation.get("velocity_topic") or "cmd_vel",
        "map": merger.get("local_map_topic") or "map",
    }
    return {purpose: Topic(str(name), WANTED[purpose]) for purpose, name in names.items()}


WANTED = {
    "scan": "sensor_msgs/LaserScan",
    "odometry": "nav_msgs/Odometry",
    "velocity": "geometry_msgs/Twist",
    "map": "nav_msgs/OccupancyGrid",
}


def folders_of(given: Parameters) -> list[str]:
    """Those that nodes write to."""
    nodes = [given[node] for node in NODES if isinstance(given.get(node), dict)]
    folders = [node.get(word) for node in nodes for word in ("log_path", "scene_path")]
    folders += [node.get("capture_file") for node in nodes]
    return [str(folder) for folder in folders if folder]


# ---- faults of parameters -----------------------------------------------------------------------------------------


def _radio_faults(given: Parameters) -> Iterator[str]:
    if frame_size_of(given) is None:
        yield f"parameter max_frame_size must be a number, not {given['max_frame_size']!r:.60}"


def _explorer_faults(given: Parameters) -> Iterator[str]:
    yield from unknown_parameters(given, explorer_options.known_names())
    yield from filter(None, [explorer_fault(given)])


def _merger_faults(given: Parameters) -> Iterator[str]:
    yield from unknown_parameters(given, set(merger_options.PARAMETERS))
    yield from filter(None, [merger_fault(given)])


def _navigation_faults(given: Parameters) -> Iterator[str]:
    """Of our node; that of ROS has its own parameters."""
    if "footprint_length" not in given:
        return
    yield from unknown_parameters(given, parameter_names.NAVIGATION)
    usual = defaults_of(NavigationOptions)
    values = {name: given[name] for name in usual if name in given}
    wrong = [name for name, value in values.items() if not isinstance(value, (int, float))]
    yield from (f"parameter {name} must be a number, not {values[name]!r:.60}" for name in wrong)
    if wrong:
        return
    try:
        NavigationOptions(**{**usual, **values})
    except NavigationError as error:
        yield str(error)


def _slam_faults(given: Parameters) -> Iterator[str]:
    """Of our node."""
    if "small_object_size" in given:
        yield from unknown_parameters(given, parameter_names.SLAM)


_CHECKS: dict[str, Callable[[Parameters], Iterator[str]]] = {
    "adhoc_communication": _radio_faults,
    "explorer": _explorer_faults,
    "map_merger": _merger_faults,
    "slam": _slam_faults,
    "move_base": _navigation_faults,
}
