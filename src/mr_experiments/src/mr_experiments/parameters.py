"""The parameters with which robots run: those of mr_launch's configuration files."""

from __future__ import annotations

import functools
from typing import Any

import yaml  # type: ignore[import-untyped]

import explorer.options
import map_merger.options
from mr_experiments import base_station
from mr_experiments.ros_packages import folder_of
from mr_experiments.trial import CENTRALIZED, Trial, TrialError
from mr_sim.navigation.options import NavigationOptions
from mr_sim.pose import Pose
from mr_sim.world_model import RangerDescription

ANOTHER_VIEW = 0.05  # rad by which a sensor's field of view differs from that of the configuration's laser
NARROW_VIEW = 3.0  # rad; a robot with a narrower one has to face what it was sent to look at
YAW_TOLERANCE = 0.25  # rad to which it does
VIEW_SHARE = 0.5  # of a sensor's range from which a frontier is looked at: beyond, noise and gaps between beams grow


@functools.lru_cache(maxsize=None)
def _configuration(node: str) -> dict[str, Any]:
    path = folder_of("mr_launch") / "config" / f"{node}.yaml"
    values = yaml.safe_load(path.read_text())
    if not isinstance(values, dict):
        raise TrialError(f"{path} holds no parameters")
    return values


def merger_options(trial: Trial, name: str, starts: dict[str, Pose]) -> map_merger.options.Options:
    """`starts`: all robots' true start poses, told if the trial says so."""
    given = dict(_configuration("map_merger"), robot_name=name)
    if trial.topology == CENTRALIZED:
        given.update(topology=trial.topology, base_station=base_station.NAME, has_local_map=name != base_station.NAME)
    if trial.known_poses:
        given["initial_poses"] = {robot: list(pose) for robot, pose in starts.items()}
    return map_merger.options.options_of(given, name)


def explorer_options(trial: Trial, name: str, index: int, ranger: RangerDescription) -> explorer.options.Options:
    """`ranger`: the robot's own, which may be another one than the laser of the configuration."""
    given = dict(_configuration("explorer"), robot_name=name, autostart=False)
    given.update(frontier_selection=trial.strategy, seed=trial.seed + index)
    options = explorer.options.load(given, 1, name)
    return explorer.options.load({**given, **_view_of(ranger, options)}, 1, name)


def _view_of(ranger: RangerDescription, laser: explorer.options.Options) -> dict[str, float]:
    """The explorer's parameters that follow the sensor: field of view in rad, distance in m of a look."""
    view = laser.field_of_view
    if abs(ranger.field_of_view - view) > ANOTHER_VIEW:
        view = ranger.field_of_view
    return {"field_of_view": view, "view_distance": min(laser.view_distance, VIEW_SHARE * ranger.range_max)}


def navigation_options(ranger: RangerDescription) -> NavigationOptions:
    """The defaults, with the heading of goals where the sensor needs it."""
    if ranger.field_of_view >= NARROW_VIEW:
        return NavigationOptions()
    return NavigationOptions(yaw_goal_tolerance=YAW_TOLERANCE)
