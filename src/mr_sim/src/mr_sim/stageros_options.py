"""What a user asks of `stageros`: its arguments, its parameters, the names that follow from them. No ROS."""

import argparse
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from mr_grid.parameter_names import unknown_parameters
from mr_sim.world import BIAS, COMMAND_TIMEOUT, ODOMETRY_MODELS

# Private parameters and their defaults; None: what the world file says.
PARAMETERS: dict[str, object] = {
    "base_watchdog_timeout": COMMAND_TIMEOUT,
    "robots": 0,
    "rtf": None,
    "seed": 0,
    "odometry": BIAS,
}
WITHOUT_EFFECT = ("is_depth_canonical",)  # parameters of the original
FASTEST = 100.0  # real-time factor
NAME = re.compile(r"[A-Za-z0-9_/]+")  # what ROS takes in names of topics and frames behind a "/"


class OptionError(ValueError):
    """An argument or a parameter that cannot be used."""


@dataclass(frozen=True)
class Arguments:
    """`passed_over`: those without an effect."""

    world: str
    use_model_names: bool
    passed_over: tuple[str, ...]


@dataclass(frozen=True)
class Options:
    """`robots`: None for all; `real_time_factor`: None for that of the world; `command_timeout`: s, inf for none."""

    command_timeout: float
    robots: int | None
    real_time_factor: float | None
    seed: int
    odometry: str


@dataclass(frozen=True)
class Prefixes:
    """Of a robot's topics and frames. Topics of several robots begin with "/" whatever the namespace of the node."""

    topics: str
    frames: str


def read_arguments(words: Sequence[str]) -> Arguments:
    """As the original takes them: the last word is the world, others than -g and -u do nothing. Ends the program if
    there is no world."""
    parser = argparse.ArgumentParser(
        prog="stageros",
        usage="stageros [-h] [-g] [-u] WORLD",
        description="A Stage world with all its robots in one node.",
        epilog="WORLD: a .world file, or the name of one of the project's worlds. Other arguments do nothing.",
        allow_abbrev=False,
    )
    parser.add_argument("-g", action="store_true", help="no window; accepted for stageros, there is never one")
    parser.add_argument("-u", action="store_true", help="prefixes are the names of the models, also for one robot")
    known, others = parser.parse_known_args(words)
    worlds = [word for word in others if not word.startswith("-")]
    if not worlds:
        parser.error("give a world, see --help")
    others.reverse()
    others.remove(worlds[-1])
    return Arguments(worlds[-1], known.u, tuple(reversed(others)))


def options_of(parameters: Mapping[str, object]) -> Options:
    """Of the node's private parameters. Raises OptionError, which names the culprit."""
    values = {**PARAMETERS, **parameters}
    timeout = _number("base_watchdog_timeout", values, -math.inf, math.inf, "number of seconds, 0 for none")
    odometry = values["odometry"]
    if odometry not in ODOMETRY_MODELS:
        raise OptionError(f"~odometry must be {' or '.join(ODOMETRY_MODELS)}, not {odometry!r}")
    given = values["rtf"] is not None
    return Options(
        command_timeout=timeout if timeout > 0.0 else math.inf,
        robots=_whole_number("robots", values) or None,
        real_time_factor=_number("rtf", values, 0.0, FASTEST, f"number from 0 to {FASTEST:g}") if given else None,
        seed=_whole_number("seed", values),
        odometry=str(odometry),
    )


def warning_of(parameters: Iterable[str], arguments: Arguments) -> str:
    """One line that names what was given and does nothing; empty if all does something."""
    given = set(parameters)
    parts = []
    passed_over = [f"~{name}" for name in WITHOUT_EFFECT if name in given]
    if passed_over:
        parts.append(f"parameters {', '.join(passed_over)}")
    if arguments.passed_over:
        parts.append(f"arguments {' '.join(arguments.passed_over)}")
    lines = [f"without effect here: {'; '.join(parts)}"] if parts else []
    return "; ".join([*lines, *unknown_parameters(given - set(WITHOUT_EFFECT), PARAMETERS)])


def prefixes(names: Sequence[str], use_model_names: bool) -> list[Prefixes]:
    """Of each robot, as the original chooses them. Raises OptionError for a name that ROS does not take."""
    if len(names) == 1 and not use_model_names:
        return [Prefixes("", "")]
    found = []
    for index, name in enumerate(names):
        # A colon is in the names that Stage makes up.
        prefix = name if use_model_names and ":" not in name else f"robot_{index}"
        if not NAME.fullmatch(prefix):
            raise OptionError(f'-u: "{name}" is no name for topics: use letters, digits and _ in the world, or no -u')
        found.append(Prefixes(f"/{prefix}/", f"{prefix}/"))
    return found


def _number(name: str, values: Mapping[str, object], low: float, high: float, wanted: str) -> float:
    value = values[name]
    if not isinstance(value, (int, float)) or isinstance(value, bool) or not low <= value <= high:
        raise OptionError(f"~{name} must be a {wanted}, not {value!r}")
    return float(value)


def _whole_number(name: str, values: Mapping[str, object]) -> int:
    value = values[name]
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise OptionError(f"~{name} must be a whole number >= 0, not {value!r}")
    return value
