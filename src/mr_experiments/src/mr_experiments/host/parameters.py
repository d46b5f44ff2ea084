"""The parameters with which robots run, as in mr_launch: those that follow from what the robot is, and those of the
configuration files."""

from __future__ import annotations

import functools
from typing import Any, NamedTuple

import yaml  # type: ignore[import-untyped]

import explorer.options
import map_merger.options
from mr_experiments.host import base_station
from mr_experiments.trial.trial import CENTRALIZED, Trial, TrialError
from mr_grid import Pose
from mr_measures.record.ros_packages import folder_of
from mr_robot.navigation.options import NavigationOptions
from mr_robot.platforms import engines
from mr_robot.platforms.parameters import explorer_parameters, merger_parameters
from mr_robot.platforms.platform import Platform
from mr_robot.slam.engine import SlamOptions

# Frames, topics and periods, which the nodes have and their engines have not.
NODES_OWN = frozenset(
    {"map_frame", "odom_frame", "base_frame", "scan_topic", "odometry_topic", "velocity_topic", "map_topic"}
    | {"robot_name", "map_update_interval", "transform_publish_period", "transform_tolerance"}
)


class Member(NamedTuple):
    """One robot of a team, and each kind of robot in that team."""

    platform: Platform
    team: tuple[Platform, ...]


@functools.lru_cache(maxsize=None)
def _configuration(node: str) -> dict[str, Any]:
    path = folder_of("mr_launch") / "config" / f"{node}.yaml"
    values = yaml.safe_load(path.read_text())
    if not isinstance(values, dict):
        raise TrialError(f"{path} holds no parameters")
    return values


def merger_options(trial: Trial, name: str, starts: dict[str, Pose], member: Member) -> map_merger.options.Options:
    """`starts`: all robots' true start poses, told if the trial says so."""
    given = {**merger_parameters(*member), **_configuration("map_merger"), "robot_name": name}
    if trial.topology == CENTRALIZED:
        given.update(topology=trial.topology, base_station=base_station.NAME, has_local_map=name != base_station.NAME)
    if trial.known_poses:
        given["initial_poses"] = {robot: list(pose) for robot, pose in starts.items()}
    return map_merger.options.options_of(given, name)


def explorer_options(trial: Trial, name: str, index: int, member: Member) -> explorer.options.Options:
    given = {**explorer_parameters(*member), **_configuration("explorer"), "robot_name": name, "autostart": False}
    given.update(frontier_selection=trial.strategy, seed=trial.seed + index)
    return explorer.options.load(given, 1, name)


def navigation_options(member: Member) -> NavigationOptions:
    return engines.navigation_options(*member, **_engine("navigation"))


def slam_options(member: Member) -> SlamOptions:
    return engines.slam_options(*member, **_engine("slam"))


def _engine(node: str) -> dict[str, Any]:
    """What the configuration of a node says for its engine."""
    return {name: value for name, value in _configuration(node).items() if name not in NODES_OWN}
