"""The parameters with which robots run: those of mr_launch's configuration files."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import rospkg
import yaml  # type: ignore[import-untyped]

import explorer.options
import map_merger.options
from mr_experiments.trial import Trial, TrialError
from mr_sim.pose import Pose


@functools.lru_cache(maxsize=None)
def _configuration(node: str) -> dict[str, Any]:
    path = Path(rospkg.RosPack().get_path("mr_launch")) / "config" / f"{node}.yaml"
    values = yaml.safe_load(path.read_text())
    if not isinstance(values, dict):
        raise TrialError(f"{path} holds no parameters")
    return values


def merger_options(trial: Trial, name: str, starts: dict[str, Pose]) -> map_merger.options.Options:
    """`starts`: all robots' true start poses, told only if the trial says so."""
    given = dict(_configuration("map_merger"), robot_name=name)
    if trial.known_poses:
        given["initial_poses"] = {robot: list(pose) for robot, pose in starts.items()}
    return map_merger.options.options_of(given, name)


def explorer_options(trial: Trial, name: str, index: int) -> explorer.options.Options:
    given = dict(_configuration("explorer"), robot_name=name, autostart=False)
    given.update(frontier_selection=trial.strategy, seed=trial.seed + index)
    return explorer.options.load(given, 1, name)
