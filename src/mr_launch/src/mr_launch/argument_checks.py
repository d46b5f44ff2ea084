"""Arguments of launch files, looked at while these are read: what nodes would refuse each time they are started again
ends roslaunch with one line."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import Any, Sequence

import yaml  # type: ignore[import-untyped]

from mr_launch.errors import UserError
from mr_launch.exit_codes import BAD_CALL, OK
from mr_launch.node_options import FAULTS, KINDS
from mr_launch.option_parser import OptionParser
from mr_robot.platforms.alternatives import OURS, check_simulator, find_package
from mr_robot.platforms.platform import PlatformError


def make_parser() -> argparse.ArgumentParser:
    parser = OptionParser(prog="check_arguments", description=__doc__)
    add = parser.add_argument
    add("parameters", nargs="*", metavar="NODE/PARAMETER=VALUE", help="as the launch file gives them to the nodes")
    add("--folders", nargs="+", default=[], metavar="FOLDER", help="with NODE.yaml, read before: later ones count")
    add("--log-path", default="", metavar="FOLDER", help="in which nodes write their logs")
    add("--simulator", default="", metavar="NAME", help="of the world")
    add("--world", default="", metavar="NAME|FILE", help="that the simulator is given")
    add("--robots", type=int, default=1, metavar="N", help="that it needs (default: 1)")
    return parser


def check_nodes(parameters: Sequence[str], folders: Sequence[Path]) -> None:
    """Raises UserError for the first node that would not start."""
    given: dict[str, dict[str, Any]] = {}
    for word in parameters:
        name, _, value = word.partition("=")
        node, _, parameter = name.partition("/")
        kind = KINDS.get(node, {}).get(parameter)
        if kind is None:
            raise UserError(f"{word!r} is no NODE/PARAMETER=VALUE of {', '.join(KINDS)}")
        given.setdefault(node, _written(node, folders))[parameter] = _converted(kind, parameter, value)
    for node, values in given.items():
        fault = FAULTS[node](values)
        if fault:
            raise UserError(f"{node}: {fault}")


def _written(node: str, folders: Sequence[Path]) -> dict[str, Any]:
    """What the files say; roslaunch itself complains of those that are not there."""
    values: dict[str, Any] = {}
    for path in (folder / f"{node}.yaml" for folder in folders):
        if path.is_file():
            found = _read(str(path), path.read_text(encoding="utf-8"))
            values.update(found if isinstance(found, dict) else {})
    return values


def _converted(kind: type, parameter: str, text: str) -> Any:
    """As a launch file makes a value of it; what cannot be of that kind stays text, for the node's own check."""
    if kind is bool:
        return {"true": True, "false": False}.get(text.lower(), text)
    if kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            return text
    return text if kind is str else _read(f"{parameter}:={text}", text)


def _read(what: str, text: str) -> Any:
    try:
        return yaml.safe_load(text) if text else ""
    except yaml.YAMLError as error:
        raise UserError(f"{what} is no YAML: {' '.join(str(error).split())}") from None


def check_log_path(log_path: str) -> None:
    """Raises UserError if no node could write there. Makes nothing, as launch files are also read to be looked at."""
    home = os.environ.get("ROS_HOME", "~/.ros")  # where roslaunch starts nodes
    folder = Path(home).expanduser() / Path(log_path).expanduser()
    there = next(place for place in (folder, *folder.parents) if os.path.exists(place))  # as far as may be seen
    if log_path and not (there.is_dir() and os.access(there, os.W_OK | os.X_OK)):
        raise UserError(f"log_path:={log_path}: {there} is no folder that can be written to")


def check_world(simulator: str, world: str, robots: int) -> None:
    """Raises UserError or PlatformError."""
    check_simulator(simulator, find_package)
    if simulator != OURS:  # it reads its worlds itself
        if not Path(world).is_file():
            raise UserError(
                f"world:={world}: there is no such file, and simulator:={simulator} takes no names of worlds"
            )
        return
    from mr_sim.world_model import load_world  # slow to import, and most calls are without a world
    from mr_sim.worlds import find_world

    try:
        description = load_world(find_world(world))
    except (ValueError, OSError) as error:
        raise UserError(f"world:={world}: {error}") from None
    there = len(description.robots)
    if there < robots:
        raise UserError(f"world:={world} has {there} robot{'' if there == 1 else 's'}, {robots} are needed")


def main(arguments: Sequence[str]) -> int:
    try:
        given = make_parser().parse_args(arguments)
        check_nodes(given.parameters, [Path(folder) for folder in given.folders])
        check_log_path(given.log_path)
        if given.simulator:
            check_world(given.simulator, given.world, given.robots)
    except (UserError, PlatformError) as error:
        print(error, file=sys.stderr)
        return BAD_CALL
    return OK
