"""`rosrun mr_robot robot_parameters`: the parameters that follow from the description of a robot, one file per node."""

import argparse
import os
import re
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import Dict, NoReturn, Optional, Sequence

import yaml  # type: ignore[import-untyped]

from mr_robot.platforms.alternatives import ALTERNATIVES, NAVIGATION, NONE, OURS, OWN, check_alternative, find_package
from mr_robot.platforms.parameters import (
    Parameters,
    explorer_parameters,
    kinds_of,
    merger_parameters,
    navigation_parameters,
    slam_parameters,
)
from mr_robot.platforms.platform import Frames, Mount, Platform, PlatformError, Topics
from mr_robot.platforms.preset import load_platform
from mr_robot.platforms.ros_stack import SLAM_PARAMETERS, move_base_parameters
from mr_robot.platforms.urdf import urdf_of

BAD_CALL = 2
_OVERRIDES = {
    "base_frame": ("frames", "base"),
    "odom_frame": ("frames", "odom"),
    "scan_topic": ("topics", "scan"),
    "odometry_topic": ("topics", "odometry"),
    "velocity_topic": ("topics", "velocity"),
}
"""Options that take the place of a word of the preset."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise PlatformError(f"{message} (--help lists the options)")


def argument_parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="robot_parameters", description=__doc__)
    add = parser.add_argument
    add("--robot", default="", metavar="NAME|FILE", help="kind of this robot (default: the first of the team)")
    add(
        "--team",
        default="",
        metavar="LIST",
        help="kinds of robots in the team, with commas between (default: this one)",
    )
    add(
        "--simulated", choices=("true", "false"), default="false", help="true: frames and topics of the simulated robot"
    )
    add("--prefix", default="", help="put before the frames, for several robots under one master: robot_0")
    for option in _OVERRIDES:
        add(f"--{option.replace('_', '-')}", default="", help="instead of the preset's")
    for argument, packages in ALTERNATIVES.items():
        there = f"{OURS}, {', '.join(packages)}, {NONE} or FILE{OWN}"
        add(f"--{argument}", default=OURS, help=f"{there} (default: %(default)s)")
    add("--urdf", action="store_true", help="print the robot as URDF instead of the parameters")
    add("--out", default="", metavar="FOLDER", help="write NODE.yaml for each node there, too (default: no files)")
    return parser


def parameters_of(
    platform: Platform, team: Sequence[Platform], slam: str = "ours", navigation: str = "ours"
) -> Dict[str, Parameters]:
    """The parameters of each node by its name."""
    team = kinds_of([platform, *team])
    of_others = SLAM_PARAMETERS.get(slam)
    navigates = move_base_parameters if navigation in NAVIGATION else navigation_parameters
    return {
        "slam": slam_parameters(platform, team) if of_others is None else of_others(platform),
        "move_base": navigates(platform, team),
        "explorer": explorer_parameters(platform, team),
        "map_merger": merger_parameters(platform, team),
        "velocity_override": {"velocity_topic": platform.topics.velocity},
        "bag": {f"{name}_topic": topic for name, topic in asdict(platform.topics).items()},
    }


def described(given: argparse.Namespace) -> Platform:
    """The robot of a call. Raises PlatformError."""
    name = given.robot or given.team.split(",")[0].strip()
    if not name:
        raise PlatformError("give the kind of robot: --robot pioneer, for example")
    platform = load_platform(name)
    if given.simulated == "true":
        mount = replace(platform.mount, frame=_numbered(platform.mount.frame, Mount.frame))
        topics = Topics(_numbered(platform.topics.scan, Topics.scan))
        platform = replace(platform, frames=Frames(), topics=topics, mount=mount)
    for option, (section, word) in _OVERRIDES.items():
        value = getattr(given, option)
        if value:
            platform = replace(platform, **{section: replace(getattr(platform, section), **{word: value})})
    platform = replace(platform, frames=_below(given.prefix, platform.frames))
    _check_remappings(platform, given)
    for argument in ALTERNATIVES:
        check_alternative(argument, getattr(given, argument), find_package)
    return platform


def _numbered(name: str, usual: str) -> str:
    """A simulated robot numbers what its rangers have, where it has several."""
    return name if re.fullmatch(rf"{usual}_\d+", name) else usual


def _below(prefix: str, frames: Frames) -> Frames:
    prefix = prefix.strip("/")
    return Frames(f"{prefix}/{frames.base}", f"{prefix}/{frames.odom}") if prefix else frames


def _check_remappings(platform: Platform, given: argparse.Namespace) -> None:
    """Nodes of other packages have no parameters for their topics: the launch file has to rename these."""
    topics = platform.topics
    renamed = [
        ("slam", ("gmapping",), "scan_topic", topics.scan, Topics.scan),
        ("navigation", tuple(NAVIGATION), "velocity_topic", topics.velocity, Topics.velocity),
    ]
    for role, nodes, option, topic, usual in renamed:
        node = getattr(given, role)
        if (node in nodes or node.endswith(OWN)) and topic not in (usual, getattr(given, option)):
            raise PlatformError(
                f"{node} does not read the topic {topic!r} of the preset: add the argument {option}:={topic}"
            )


def write(folder: Path, parameters: Dict[str, Parameters]) -> None:
    """One YAML file per node. A reader sees the old file or the new one. Raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    for node, values in parameters.items():
        partial = folder / f".{node}.{os.getpid()}"
        partial.write_text(yaml.safe_dump(values, sort_keys=False), encoding="utf-8")
        partial.rename(folder / f"{node}.yaml")


def main(arguments: Optional[Sequence[str]] = None) -> int:
    try:
        given = argument_parser().parse_args(arguments)
        platform = described(given)
        team = [load_platform(name.strip()) for name in given.team.split(",") if name.strip()]
        parameters = parameters_of(platform, team, given.slam, given.navigation)
        if given.out:
            write(Path(given.out), parameters)
    except (PlatformError, OSError) as error:
        print(f"robot_parameters: {error}", file=sys.stderr)
        return BAD_CALL
    if given.urdf:
        print(urdf_of(platform), end="")
        return 0
    print(yaml.safe_dump({"robot": asdict(platform), **parameters}, sort_keys=False), end="")
    return 0
