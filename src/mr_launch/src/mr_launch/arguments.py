"""Command line of ``rosrun mr_launch team``: options, their limits and their defaults."""

from __future__ import annotations

import argparse
import math
import os
import time
from dataclasses import asdict, dataclass
from typing import Any, Callable, Collection, Mapping, Sequence

from mr_launch.errors import UserError
from mr_launch.option_parser import OptionParser
from mr_launch.programs import NAVIGATION, SLAM
from mr_page.address import PORT
from mr_robot.platforms.alternatives import OWN

STRATEGY = 7
_FOLDERS = (".", "..", "logs", "robots")  # what is beside the robots' folders in --out
_NOT_IN_PATHS = ",'\""
LIMITS = {  # option: (lowest, highest, unit)
    "range": (0.1, 10000.0, "m"),
    "loss": (0.0, 0.95, ""),
    "wall-attenuation": (0.0, 1000.0, "dB"),
    "rtf": (0.0, 100.0, ""),
    "duration": (1.0, 86400.0, "s"),
    "seed": (0, 2**31 - 1, ""),
    "page": (0, 65535, ""),
}


@dataclass(frozen=True)
class Options:
    """What the user asked for, checked for itself (not yet against the world file)."""

    world: str
    starts: list[float]
    robots: int | None
    range: float
    loss: float
    wall_attenuation: float
    rtf: float
    seed: int
    duration: float
    out: str
    strategy: int
    slam: str
    navigation: str
    bag: bool
    initial_poses: bool
    quiet: bool
    isolation: str
    topology: str
    odometry: str
    open: bool = False
    page: int = 0  # port of the status page; 0: there is none
    respawn: bool = False
    time_limit: float = 0.0  # s after which each robot ends its exploration; 0: none
    distance_limit: float = 0.0  # m of way, likewise

    def to_dict(self) -> dict[str, Any]:
        return asdict(self)


def _alternative_of(known: Collection[str]) -> Callable[[str], str]:
    def alternative(text: str) -> str:
        """A known name, or the whole path of a launch file that is there."""
        if text in known:
            return text
        if not text.endswith(OWN):
            raise argparse.ArgumentTypeError(f"{text!r} is unknown; there are {', '.join(known)}, and FILE{OWN}")
        if not os.path.isfile(text):
            raise argparse.ArgumentTypeError(f"there is no file {text!r}")
        return os.path.abspath(text)

    return alternative


def known_strategies() -> Mapping[int, str]:
    """Numbers and titles."""
    from explorer.options import STRATEGIES  # slow to import; many processes need the options' type alone

    return STRATEGIES


def strategy_number(text: str) -> int:
    """Of a strategy by number or name. Raises UserError that lists them."""
    from explorer.strategies import number_of  # as above

    try:
        return number_of(text)
    except KeyError as error:
        raise UserError(f"--strategy: {error.args[0]}") from None


def _check_limits(values: Mapping[str, Any]) -> None:
    """Raises UserError for what the explorer would refuse."""
    from mr_launch.node_options import explorer_fault  # as above

    for name in ("time_limit", "distance_limit"):
        fault = explorer_fault({name: values[name]})
        if fault:
            raise UserError(f"--{name.replace('_', '-')} {values[name]:g}: {fault}")


def make_parser() -> argparse.ArgumentParser:
    parser = OptionParser(
        prog="team",
        description="A team of robots, each with its own ROS master and its own radio, explores a Stage world.",
        epilog="Exit code: 0 every robot finished, 1 not all finished or a failure, 2 bad options, 130 interrupted.",
    )
    add = parser.add_argument
    add("--world", default="office26x15", metavar="NAME|FILE", help="world by name or file, a map's .yaml file, or "
        "generated:KIND:SEED, which is drawn (default: %(default)s)")  # fmt: skip
    add("--starts", type=float, nargs="+", default=[], metavar="X Y DEGREES", help="start poses of the robots in a map")
    add(
        "--robots",
        type=int,
        default=None,
        metavar="N",
        help="number of robots (default: 3, or all if the world has less)",
    )
    add("--range", type=float, default=10.0, metavar="M", help="reach of the radio in m (default: %(default)s)")
    add("--loss", type=float, default=0.05, metavar="P", help="loss per frame and direction (default: %(default)s)")
    add(
        "--wall-attenuation",
        type=float,
        default=0.0,
        metavar="DB",
        help="dB that the radio loses in each wall of the world's floor plan, 10 is usual and costs 44 %% of the reach "
        "(default: 0, walls do not matter)",
    )
    add(
        "--rtf",
        type=float,
        default=1.0,
        metavar="F",
        help="real-time factor of world and radio, 0 = as fast as it goes, the radio at 1 (default: 1.0)",
    )
    add("--seed", type=int, default=1, metavar="N", help="seed of world and radio (default: %(default)s)")
    add("--duration", type=float, default=900.0, metavar="S", help="limit in s of simulation time (default: 900)")
    for option, unit, what in (("--time-limit", "s", "simulation time"), ("--distance-limit", "m", "way")):
        ends = f"{unit} of {what} after which each robot ends its exploration and drives home (default: 0, none)"
        add(option, type=float, default=0.0, metavar=unit.upper(), help=ends)
    add(
        "--out",
        default="",
        metavar="DIR",
        help="output folder (default: out/<time>); out/latest points to the newest one there",
    )
    strategies = "; ".join(f"{number}: {text}" for number, text in known_strategies().items())
    add(
        "--strategy",
        default=str(STRATEGY),
        metavar="N|NAME",
        help=f"frontier selection: {strategies} (default: {STRATEGY})",
    )
    for role, known in (("slam", SLAM), ("navigation", NAVIGATION)):
        there = f"{', '.join(known)}, or a launch file of your own (default: ours)"
        add(f"--{role}", type=_alternative_of(known), default="ours", metavar="NAME|FILE.launch", help=there)
    add("--no-bag", dest="bag", action="store_false", help="record no bags")
    add("--initial-poses", action="store_true", help="tell the robots each other's start poses")
    add(
        "--topology",
        choices=("distributed", "centralized"),
        default="distributed",
        help="distributed: every robot merges maps; centralized: a base station at the start of the first robot merges "
        "for all (default: %(default)s)",
    )
    add("--odometry", choices=("bias", "random_walk"), default="bias", help="how it errs: by one share for the whole "
        "mission, or anew at each step (default: %(default)s)")  # fmt: skip
    add("--open", action="store_true", help="open frames; else the team gets a key, in team.key of --out")
    add(
        "--page",
        type=int,
        nargs="?",
        default=0,
        const=PORT,
        metavar="PORT",
        help=f"serve a status page at http://localhost:PORT (default of PORT: {PORT})",
    )
    add("--respawn", action="store_true", help="a node that ends is started again; else the mission ends with it")
    add("--quiet", action="store_true", help="print only notices, errors and the final table")
    add(
        "--isolation",
        choices=("auto", "namespaces", "hub"),
        default="auto",
        help="namespaces: one network namespace and raw sockets per robot; hub: one port per master, the radio over "
        "Unix sockets; auto: namespaces where the system allows them (default)",
    )
    return parser


def parse_arguments(arguments: Sequence[str], now: float | None = None) -> Options:
    """Options from the command line; raises UserError for values that no world could make right."""
    values = vars(make_parser().parse_args(arguments))
    for name, (lowest, highest, unit) in LIMITS.items():
        value = values[name.replace("-", "_")]
        if not (math.isfinite(value) and lowest <= value <= highest):
            raise UserError(f"--{name} {value:g} is out of range: {lowest:g} to {highest:g} {unit}".rstrip())
    _check_limits(values)
    values["strategy"] = strategy_number(values["strategy"])
    if values["robots"] is not None and values["robots"] < 1:
        raise UserError(f"--robots {values['robots']}: a team has at least one robot")
    if not values["out"]:
        stamp = time.strftime("%Y-%m-%d_%H-%M-%S", time.localtime(now))
        values["out"] = f"out/{stamp}"
    check_folder(os.path.abspath(values["out"]))
    return Options(**values)


def check_folder(path: str) -> None:
    """Its name goes through launch files: in quotes, and in lists with commas. Raises UserError."""
    culprits = [character for character in _NOT_IN_PATHS if character in path]
    if culprits:
        raise UserError(
            f"--out {path} has a {culprits[0]} in it, which launch files do not take; choose another folder"
        )


def _check_name(name: str, world: str) -> None:
    """It names nodes' logs and folders, and is what the radio calls the robot."""
    from mr_sim.simulated_platform import name_fault  # slow to import

    fault = name_fault(name)
    if fault or name in _FOLDERS:
        raise UserError(
            f"{world} has a robot named {name!r:.80}; {fault or 'it cannot be one of ' + ', '.join(_FOLDERS)}"
        )


def choose_robots(asked: int | None, names: Sequence[str], world: str) -> list[str]:
    """Names of the team's robots: the first ones of the world file, checked to be there and to be unique."""
    doubles = sorted({name for name in names if names.count(name) > 1})
    if doubles:
        raise UserError(f"{world} uses the robot name {doubles[0]} more than once; each robot needs its own name")
    if not names:
        raise UserError(f'{world} holds no robot (a position model with drive "diff" and a name)')
    count = min(3, len(names)) if asked is None else asked
    if count > len(names):
        raise UserError(f"--robots {count}, but {world} has {len(names)}: {', '.join(names)}")
    chosen = list(names[:count])
    for name in chosen:
        _check_name(name, world)
    return chosen
