"""The parameters of the node, in one place: name, type, default, range, meaning. README.md repeats them."""

import math
import re
import socket
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Set, Tuple

from explorer import strategies
from explorer.errors import ParameterError
from explorer.limits import Limits
from mr_grid import FARTHEST, is_place
from mr_grid.topic_names import is_topic_name

STRATEGIES = strategies.TITLES


@dataclass(frozen=True)
class Parameter:
    """One parameter: `accepts` tells whether a value of the right type is in range, `range_text` says so."""

    name: str
    type: type
    default: Any
    meaning: str
    range_text: str = ""
    accepts: Optional[Callable[[Any], bool]] = None
    private: bool = True

    @property
    def shown(self) -> str:
        return f"~{self.name}" if self.private else self.name


def _between(low: float, high: float) -> Dict[str, Any]:
    return {
        "range_text": f"{low:g} to {high:g}",
        "accepts": lambda value: math.isfinite(value) and low <= value <= high,
    }


def _strategy_numbers() -> Dict[str, Any]:
    own = strategies.BUILT_IN
    outside = [str(number) for number in STRATEGIES if number not in own]
    return {
        "range_text": ", ".join([f"{own[0]} to {own[-1]}", *outside]),
        "accepts": lambda value: value in STRATEGIES,
    }


PARAMETERS: Tuple[Parameter, ...] = (
    Parameter("frontier_selection", int, 1, "strategy, see Strategies", **_strategy_numbers()),
    Parameter(
        "strategy",
        str,
        "",
        "name or place (module:Class, FILE.py:Class) of a strategy, in place of frontier_selection",
    ),
    Parameter("robot_prefix", str, "", "empty: real robot; else simulation with one master, such as /robot_0"),
    Parameter("move_base_frame", str, "map", "frame of goals; in simulation it carries the number: /robot_0/map"),
    Parameter("wait_for_planner_result", int, 3, "seconds in which move_base must accept a goal", **_between(1, 600)),
    Parameter("number_unreachable_for_cluster", int, 3, "failed goals that give a cluster up", **_between(1, 1000)),
    Parameter("local_costmap/width", int, 0, "m, reported in the log"),
    Parameter("local_costmap/height", int, -1, "m, reported in the log"),
    Parameter("log_path", str, "", "root of the log files; empty: none are written"),
    Parameter("scene_path", str, "", "root of recorded decisions, the newest 1000 of a robot; empty: none are written"),
    Parameter("robot_name", str, "", "own name, equal to the name in adhoc_communication; empty: host name"),
    Parameter("base_link", str, "", "robot's frame; empty: base_link, in simulation robot_<n>/base_link"),
    Parameter("map_topic", str, "map_merger/global_map", "map to explore on"),
    Parameter("local_map_metadata_topic", str, "map_metadata", "tells when the robot's own SLAM map was updated"),
    Parameter("autostart", bool, True, "start as soon as map, pose and move_base are there; else ~start starts"),
    Parameter("inflation_radius", float, 0.25, "m, the centre keeps this from obstacles", **_between(0.01, 5.0)),
    Parameter(
        "largest_robot_radius", float, 0.29, "m, of the team's largest robot to its corner", **_between(0.02, 5.0)
    ),
    Parameter("minimal_frontier_length", float, 0.4, "m, shorter frontiers are noise", **_between(0.0, 10.0)),
    Parameter("view_distance", float, 1.5, "m, a frontier is looked at from this far at most", **_between(0.3, 20.0)),
    Parameter("field_of_view", float, 4.71, "rad, of the sensor", **_between(0.1, 6.2832)),
    Parameter("auction_timeout", float, 1.0, "s, an auction waits so long for bids", **_between(0.05, 60.0)),
    Parameter("claim_timeout", float, 30.0, "s, after which a silent robot's cluster is free", **_between(1.0, 3600.0)),
    Parameter("progress_timeout", float, 20.0, "s without progress that fail a goal", **_between(1.0, 3600.0)),
    Parameter("finish_delay", float, 3.0, "s without a reachable frontier before the end", **_between(0.0, 600.0)),
    Parameter("time_limit", float, 0.0, "s of exploration after which it ends; 0: none", **_between(0.0, 1e6)),
    Parameter("distance_limit", float, 0.0, "m driven after which it ends; 0: none", **_between(0.0, 1e6)),
    Parameter("return_home", bool, True, "drive to the home pose at the end"),
    Parameter("home_pose", list, [], "x, y, yaw in m and rad; empty: the pose at the start"),
    Parameter("memory", str, "", "set: the node keeps there what it needs to go on with its mission after a crash"),
    Parameter("seed", int, 0, "of the random choices of strategies 4 and 6", **_between(0, 2**31 - 1)),
)

DEFAULTS: Dict[str, Any] = {parameter.name: parameter.default for parameter in PARAMETERS}

# Relative, of all robots under one master. Logged, as in the original.
ROBOTS_IN_SIMULATION = Parameter(
    "robots_in_simulation", int, 1, "number of robots, logged", **_between(0, 100000), private=False
)

# Parameters of the original that are accepted without an effect, with the reason; they warn once when set.
WITHOUT_EFFECT: Dict[str, str] = {
    "global_costmap": "frontiers are found on the map of map_topic itself, there is no costmap in this node",
    "local_costmap": "there is no local costmap in this node; only its width and height are reported, and lengths are"
    " in metres",
}


@dataclass(frozen=True)
class Options:
    """All parameters after checking, and the robot's identity. Attribute `local_costmap_width` holds
    `local_costmap/width`, and so on. What has no default follows from the robot; `load` takes a usual one where nobody
    says what it is."""

    inflation_radius: float
    largest_robot_radius: float
    view_distance: float
    field_of_view: float
    frontier_selection: int = 1
    strategy: str = ""
    robot_prefix: str = ""
    move_base_frame: str = "map"
    wait_for_planner_result: int = 3
    number_unreachable_for_cluster: int = 3
    local_costmap_width: int = 0
    local_costmap_height: int = -1
    log_path: str = ""
    scene_path: str = ""
    robot_name: str = "robot_0"
    base_link: str = "base_link"
    map_topic: str = "map_merger/global_map"
    local_map_metadata_topic: str = "map_metadata"
    autostart: bool = True
    minimal_frontier_length: float = 0.4
    auction_timeout: float = 1.0
    claim_timeout: float = 30.0
    progress_timeout: float = 20.0
    finish_delay: float = 3.0
    time_limit: float = 0.0
    distance_limit: float = 0.0
    return_home: bool = True
    home_pose: Tuple[float, ...] = field(default_factory=tuple)
    memory: str = ""
    seed: int = 0
    robots_in_simulation: int = 1

    @property
    def simulation(self) -> bool:
        return bool(self.robot_prefix)

    @property
    def robot_number(self) -> int:
        """Number in the robot's name, 0 for a name without one."""
        return number_of(self.robot_name)

    @property
    def group(self) -> str:
        """The multicast group of which this robot is the root."""
        return f"mc_{self.robot_name}"


def number_of(robot_name: str) -> int:
    found = re.fullmatch(r"/?robot_(\d+)", robot_name)
    return int(found.group(1)) if found else 0


def load(given: Mapping[str, Any], robots_in_simulation: Any = 1, host_name: Optional[str] = None) -> Options:
    """Checks the private parameters of the node (nested mappings as the parameter server gives them).

    Raises `ParameterError` naming the first parameter that cannot be used. Identity: in simulation the number in
    `move_base_frame` (contract 3.1, any number of digits), else `robot_name`, else the host name.
    """
    values: Dict[str, Any] = {}
    for parameter in PARAMETERS:
        values[parameter.name.replace("/", "_")] = _checked(parameter, _lookup(given, parameter.name))
    values["frontier_selection"] = _selected(values["strategy"], values["frontier_selection"])
    for name in ("map_topic", "local_map_metadata_topic"):
        if not is_topic_name(values[name]):
            raise ParameterError(f"parameter ~{name} is {values[name]!r}, it must be the name of a topic")
    values["home_pose"] = _pose(values["home_pose"])
    values["robots_in_simulation"] = _checked(ROBOTS_IN_SIMULATION, robots_in_simulation)
    _identify(values, host_name if host_name is not None else socket.gethostname())
    return Options(**values)


def checked_limits(time: float, distance: float) -> Limits:
    """Values for `time_limit` in s and `distance_limit` in m. Raises `ParameterError` as `load`."""
    found = {parameter.name: parameter for parameter in PARAMETERS}
    return Limits(_checked(found["time_limit"], time), _checked(found["distance_limit"], distance))


def summary(options: Options) -> str:
    """The line at the start of the node."""
    title = strategies.strategy_of(options.frontier_selection).title
    return (
        f"robot {options.robot_name}, strategy {options.frontier_selection}: {title};"
        f" robots in simulation: {options.robots_in_simulation}"
    )


def known_names() -> Set[str]:
    """Of parameters and of groups of them, also of those without effect."""
    return {parameter.name.split("/")[0] for parameter in PARAMETERS} | set(WITHOUT_EFFECT)


def warnings(given: Mapping[str, Any]) -> List[str]:
    """One line for each group of parameters that is set and has no effect."""
    effective = {parameter.name for parameter in PARAMETERS}
    lines = []
    for group, reason in WITHOUT_EFFECT.items():
        under = given.get(group)
        names = [f"{group}/{name}" for name in under] if isinstance(under, Mapping) else []
        useless = sorted(name for name in names if name not in effective)
        if useless:
            lines.append(f"no effect: ~{', ~'.join(useless)}: {reason}")
    return lines


def _lookup(given: Mapping[str, Any], name: str) -> Any:
    value: Any = given
    for part in name.split("/"):
        if not isinstance(value, Mapping) or part not in value:
            return None
        value = value[part]
    return value


def _checked(parameter: Parameter, value: Any) -> Any:
    if value is None:
        return parameter.default
    if parameter.type is float and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if not isinstance(value, parameter.type) or (parameter.type is int and isinstance(value, bool)):
        raise ParameterError(
            f"parameter {parameter.shown} is {value!r}, it must be of type {parameter.type.__name__}"
            f" (default {parameter.default!r})"
        )
    if parameter.accepts is not None and not parameter.accepts(value):
        hint = ""
        if parameter.name == "frontier_selection":
            hint = ": " + "; ".join(f"{number} {text}" for number, text in STRATEGIES.items())
        raise ParameterError(
            f"parameter {parameter.shown} is {value!r}, out of range {parameter.range_text}"
            f" (default {parameter.default!r}){hint}"
        )
    return value


def _selected(name: str, number: int) -> int:
    """Number of the strategy of that name or place, or `number` without a name."""
    if not name:
        return number
    try:
        return strategies.strategy_of(name).number
    except KeyError as error:
        raise ParameterError(f"parameter ~strategy is {name!r}: {error.args[0]}") from error


def _pose(values: Sequence[Any]) -> Tuple[float, ...]:
    numbers = all(isinstance(value, (int, float)) and is_place(value) for value in values)
    if len(values) not in (0, 3) or not numbers:
        raise ParameterError(
            f"parameter ~home_pose is {list(values)!r}, it must be empty or [x, y, yaw] in m and rad,"
            f" within {FARTHEST:g} m"
        )
    return tuple(float(value) for value in values)


def _identify(values: Dict[str, Any], host_name: str) -> None:
    prefix = values["robot_prefix"]
    if prefix:
        found = re.match(r"/?robot_(\d+)/", values["move_base_frame"])
        if not found:
            raise ParameterError(
                f"parameter ~move_base_frame is {values['move_base_frame']!r}; with ~robot_prefix set ({prefix!r}) it"
                " must carry the robot's number, such as /robot_0/map"
            )
        name = f"robot_{found.group(1)}"
        if prefix.strip("/") != name:
            raise ParameterError(
                f"parameter ~robot_prefix is {prefix!r}, but ~move_base_frame {values['move_base_frame']!r} belongs"
                f" to {name}; give both the same robot"
            )
        values["robot_prefix"] = "/" + prefix.strip("/")
        values["base_link"] = values["base_link"] or f"{name}/base_link"
    else:
        name = values["robot_name"].strip("/") or host_name
        values["base_link"] = values["base_link"] or "base_link"
    if not re.fullmatch(r"[A-Za-z0-9_.\-]+", name):
        raise ParameterError(f"robot name {name!r} holds more than letters, digits and _.-; set ~robot_name")
    if not values["move_base_frame"].strip("/"):
        raise ParameterError("parameter ~move_base_frame is empty; give the frame of the map, such as map")
    values["robot_name"] = name
