"""Scenarios: what a series of trials has in common, in small YAML files."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable, Mapping

import rospkg
import yaml  # type: ignore[import-untyped]

from mr_experiments.radio import RadioOptions
from mr_experiments.trial import Trial, TrialError
from mr_sim.pose import Pose

DEFAULT = "paper"


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
    deaths: Mapping[int, float] = field(default_factory=dict)

    def trial(self, robots: int, strategy: int, seed: int, world: str = "") -> Trial:
        """Robots that join or die but are not in the team do not count."""
        return Trial(
            world or self.world, robots, seed, self.name, strategy, self.limit, self.fast, self.radio, self.known_poses,
            self.starts[:robots], _of(self.joins, robots), _of(self.deaths, robots),
        )  # fmt: skip


def _of(times: Mapping[int, float], robots: int) -> dict[int, float]:
    return {robot: time for robot, time in times.items() if robot < robots}


def scenario_folder() -> Path:
    """Where the scenarios of this package are."""
    return Path(rospkg.RosPack().get_path("mr_experiments")) / "scenarios"


def known_scenarios() -> dict[str, Path]:
    return {path.stem: path for path in sorted(scenario_folder().glob("*.yaml"))}


def load_scenario(name: str) -> Scenario:
    """By name or file. TrialError names the file and what is wrong in it."""
    known = known_scenarios()
    path = Path(name) if name.endswith((".yaml", ".yml")) else known.get(name)
    if path is None:
        raise TrialError(f"there is no scenario {name!r}; there are {', '.join(known)}, or name a .yaml file")
    try:
        values = yaml.safe_load(path.read_text(encoding="utf-8"))
        return _scenario_of(path.stem, values)
    except (OSError, yaml.YAMLError, TrialError, TypeError, ValueError) as error:
        raise TrialError(f"{path}: {error}") from None


def _scenario_of(name: str, values: Any) -> Scenario:
    if not isinstance(values, dict):
        raise TrialError("a scenario is a mapping, see the README of mr_experiments")
    unknown = sorted(set(values) - set(_KEYS))
    if unknown:
        raise TrialError(f"unknown key {unknown[0]!r}; there are {', '.join(_KEYS)}")
    if not isinstance(values.get("description"), str):
        raise TrialError("'description' is missing: one sentence for people")
    return Scenario(name, **{key: _KEYS[key](value) for key, value in values.items()})


def _numbers(value: Any) -> tuple[int, ...]:
    if not (isinstance(value, list) and value and all(type(number) is int for number in value)):
        raise TrialError(f"expected a list of whole numbers, not {value!r}")
    return tuple(value)


def _seconds(value: Any) -> dict[int, float]:
    if not isinstance(value, dict):
        raise TrialError(f"expected robot: seconds, not {value!r}")
    return {int(robot): float(time) for robot, time in value.items()}


def _poses(value: Any) -> tuple[Pose, ...]:
    """x, y in m and the heading in degrees, as in world files."""
    return tuple((float(x), float(y), math.radians(float(degrees))) for x, y, degrees in value)


def _radio(value: Any) -> RadioOptions:
    known = RadioOptions.__dataclass_fields__
    unknown = sorted(set(value) - set(known))
    if unknown:
        raise TrialError(f"radio: unknown key {unknown[0]!r}; there are {', '.join(known)}")
    return RadioOptions(**value)


def _flag(value: Any) -> bool:
    if not isinstance(value, bool):
        raise TrialError(f"expected true or false, not {value!r}")
    return value


_KEYS: dict[str, Callable[[Any], Any]] = {
    "description": str, "world": str, "robots": _numbers, "strategies": _numbers, "limit": float, "fast": _flag,
    "known_poses": _flag, "radio": _radio, "starts": _poses, "joins": _seconds, "deaths": _seconds,
}  # fmt: skip
