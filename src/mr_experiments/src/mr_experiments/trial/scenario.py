"""Scenarios: what a series of trials has in common, in small YAML files."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable, Iterable, Mapping, TypeVar

import numpy as np
import yaml  # type: ignore[import-untyped]

from explorer.options import STRATEGIES
from mr_experiments.trial.radio_options import RadioOptions
from mr_experiments.trial.trial import DISTRIBUTED, Trial, TrialError, known_strategies
from mr_grid import Pose
from mr_measures.record.ros_packages import folder_of
from mr_sim.world import BIAS
from mr_sim.world_names import name_of

DEFAULT = "paper"

T = TypeVar("T")

Span = tuple[float, float]
"""A time between these two, in s, that each mission draws from its seed."""


@dataclass(frozen=True)
class Scenario:
    """`starts`: world frame, for as many robots as there are, or empty for those of the world file."""

    name: str
    description: str
    world: str = "office26x15"
    robots: tuple[int, ...] = (1, 2, 3, 4)
    strategies: tuple[int, ...] = (7,)
    limit: float = 1800.0
    fast: bool = False
    known_poses: bool = False
    radio: RadioOptions = field(default_factory=RadioOptions)
    starts: tuple[Pose, ...] = ()
    joins: Mapping[int, float] = field(default_factory=dict)
    deaths: Mapping[int, float | Span] = field(default_factory=dict)
    topology: str = DISTRIBUTED
    partition: tuple[float, float] | None = None
    base: tuple[float, float] | None = None
    odometry: str = BIAS

    def trial(self, robots: int, strategy: int, seed: int, world: str = "") -> Trial:
        """Robots that join or die but are not in the team do not count."""
        return Trial(
            name_of(world or self.world), robots, seed, self.name, strategy, self.limit, self.fast, self.radio,
            self.known_poses, self.starts[:robots], _of(self.joins, robots), _drawn(_of(self.deaths, robots), seed),
            self.topology, self.partition, self.base, self.odometry,
        )  # fmt: skip


def _of(times: Mapping[int, T], robots: int) -> dict[int, T]:
    return {robot: time for robot, time in times.items() if robot < robots}


def _drawn(times: Mapping[int, float | Span], seed: int) -> dict[int, float]:
    random = {robot: np.random.default_rng([seed, robot]) for robot in times}
    return {
        robot: round(float(random[robot].uniform(*time)), 1) if isinstance(time, tuple) else time
        for robot, time in times.items()
    }


def scenario_folder() -> Path:
    """Where the scenarios of this package are."""
    return folder_of("mr_experiments") / "scenarios"


def known_scenarios() -> dict[str, Path]:
    return {path.stem: path for path in sorted(scenario_folder().glob("*.yaml"))}


def load_scenario(name: str) -> Scenario:
    """By name or file. TrialError names the file and what is wrong in it."""
    known = known_scenarios()
    path = Path(name) if name.endswith((".yaml", ".yml")) else known.get(name)
    if path is None:
        raise TrialError(f"there is no scenario {name!r}; there are {', '.join(known)}, or name a .yaml file")
    try:
        return _scenario_of(path.stem, yaml.safe_load(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise TrialError(f"{path}: {error.strerror}") from None
    except (yaml.YAMLError, ValueError) as error:
        raise TrialError(f"{path}: {' '.join(str(error).split())}") from None


def _scenario_of(name: str, values: Any) -> Scenario:
    if not isinstance(values, dict):
        raise TrialError("a scenario is a mapping with these keys: " + ", ".join(_KEYS))
    _check_keys(values, _KEYS)
    if "description" not in values:
        raise TrialError("'description' is missing: one sentence for people")
    return Scenario(name, **{key: _read(key, _KEYS[key], value) for key, value in values.items()})


def _check_keys(values: Mapping[Any, Any], known: Iterable[str]) -> None:
    unknown = [key for key in values if key not in known]
    if unknown:
        raise TrialError(f"unknown key {unknown[0]!r}; there are {', '.join(known)}")


def _read(key: str, reader: Callable[[Any], Any], value: Any) -> Any:
    try:
        return reader(value)
    except TrialError as error:
        raise TrialError(f"{key}: {error}") from None


def _text(value: Any) -> str:
    if not (isinstance(value, str) and value):
        raise TrialError(f"expected a text, not {value!r}")
    return value


def _flag(value: Any) -> bool:
    if not isinstance(value, bool):
        raise TrialError(f"expected true or false, not {value!r}")
    return value


def _number(value: Any) -> float:
    """YAML reads 5e7 as a text, to the surprise of people."""
    try:
        if isinstance(value, bool):
            raise TypeError
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise TrialError(f"expected a number, not {value!r:.40}") from None
    if math.isnan(number):
        raise TrialError("expected a number, not nan")
    return number


def _at_least(least: float, most: float = math.inf) -> Callable[[Any], float]:
    def read(value: Any) -> float:
        number = _number(value)
        if not least <= number <= most:
            limits = f"of at least {least:g}" if math.isinf(most) else f"between {least:g} and {most:g}"
            raise TrialError(f"expected a number {limits}, not {value!r}")
        return number

    return read


def _positive(value: Any) -> float:
    number = _number(value)
    if number <= 0.0:
        raise TrialError(f"expected a positive number, not {value!r}")
    return number


def _finite_positive(value: Any) -> float:
    number = _positive(value)
    if math.isinf(number):
        raise TrialError(f"expected a finite number, not {value!r}")
    return number


def _whole_numbers(value: Any) -> tuple[int, ...]:
    if not (isinstance(value, list) and value and all(type(number) is int for number in value)):
        raise TrialError(f"expected a list of whole numbers, not {value!r}")
    return tuple(value)


def _team_sizes(value: Any) -> tuple[int, ...]:
    sizes = _whole_numbers(value)
    if min(sizes) < 1:
        raise TrialError(f"a team has at least one robot, not {min(sizes)}")
    return sizes


def _strategies(value: Any) -> tuple[int, ...]:
    numbers = _whole_numbers(value)
    for number in numbers:
        if number not in STRATEGIES:
            raise TrialError(f"{number} is unknown; there are {known_strategies()}")
    return numbers


def _seconds(value: Any) -> dict[int, float]:
    """Of robots by their index."""
    if not isinstance(value, dict):
        raise TrialError(f"expected robot: seconds, not {value!r}")
    for robot in value:
        if type(robot) is not int or robot < 0:
            raise TrialError(f"expected the index of a robot, 0 or above, not {robot!r}")
    return {robot: _read(f"robot {robot}", _finite_positive, time) for robot, time in value.items()}


def _spans(value: Any) -> dict[int, float | Span]:
    """As `_seconds`, or [from, to] for a time in between."""
    spans = {robot: time for robot, time in value.items() if isinstance(time, list)} if isinstance(value, dict) else {}
    times = _seconds(value if not spans else {robot: time for robot, time in value.items() if robot not in spans})
    return {**times, **{robot: _read(f"robot {robot}", _span, time) for robot, time in spans.items()}}


def _span(value: Any) -> Span:
    if not (isinstance(value, list) and len(value) == 2):
        raise TrialError(f"expected [from, to] in s, not {value!r}")
    begin, end = (_finite_positive(number) for number in value)
    if begin >= end:
        raise TrialError(f"expected a time and a later one, not {value!r}")
    return (begin, end)


def _poses(value: Any) -> tuple[Pose, ...]:
    """x, y in m and the heading in degrees, as in world files."""
    if not isinstance(value, list):
        raise TrialError(f"expected a list of [x, y, degrees], not {value!r}")
    return tuple(_pose(pose) for pose in value)


def _pose(value: Any) -> Pose:
    if not (isinstance(value, list) and len(value) == 3):
        raise TrialError(f"expected [x, y, degrees], not {value!r}")
    x, y, degrees = (_number(number) for number in value)
    if not all(map(math.isfinite, (x, y, degrees))):
        raise TrialError(f"expected finite numbers, not {value!r}")
    return Pose(x, y, math.radians(degrees))


def _place(value: Any) -> tuple[float, float]:
    if not (isinstance(value, list) and len(value) == 2):
        raise TrialError(f"expected [x, y] in m, not {value!r}")
    x, y = (_number(number) for number in value)
    if not (math.isfinite(x) and math.isfinite(y)):
        raise TrialError(f"expected finite numbers, not {value!r}")
    return (x, y)


def _radio(value: Any) -> RadioOptions:
    if not isinstance(value, dict):
        raise TrialError(f"expected a mapping with some of {', '.join(_RADIO_KEYS)}, not {value!r}")
    _check_keys(value, _RADIO_KEYS)
    return RadioOptions(**{key: _read(key, _RADIO_KEYS[key], option) for key, option in value.items()})


_RADIO_KEYS: dict[str, Callable[[Any], Any]] = {
    "range": _positive, "loss": _at_least(0.0, 1.0), "bit_rate": _finite_positive, "wall_attenuation": _at_least(0.0),
    "contention": _flag, "sealed": _flag,
}  # fmt: skip

_KEYS: dict[str, Callable[[Any], Any]] = {
    "description": _text, "world": _text, "robots": _team_sizes, "strategies": _strategies, "limit": _finite_positive,
    "fast": _flag, "known_poses": _flag, "radio": _radio, "starts": _poses, "joins": _seconds, "deaths": _spans,
    "topology": _text, "partition": _span, "base": _place, "odometry": _text,
}  # fmt: skip
