"""Parameters of the node: names, types, defaults and bounds in one table (contract 2.1 and additions)."""

import math
import re
from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Tuple

from mr_grid import Pose, pose_of
from mr_grid.by_place import PlaceError, names_a_place
from mr_grid.topic_names import is_topic_name

from .messages import NO_BOOT, Boot
from .methods import METHODS, method_of
from .robot_size import USUAL_SIZE, RobotSize


class OptionError(ValueError):
    """A parameter that cannot be used; the text names it, its value and what is expected."""


class Parameter(NamedTuple):
    """One parameter: type, default, smallest value, a further allowed value outside the bounds, and largest value."""

    kind: type
    default: Any
    least: Optional[float] = None
    also: Optional[float] = None
    choices: Tuple[str, ...] = ()
    most: Optional[float] = None


PARAMETERS: Dict[str, Parameter] = {
    "robot_name": Parameter(str, ""),
    "robot_prefix": Parameter(str, ""),
    "local_map_frame_id": Parameter(str, "map"),
    "local_map_topic": Parameter(str, "/map"),
    "local_map_metadata_topic": Parameter(str, "/map_metadata"),
    "map_topic_over_network": Parameter(str, "map_other"),
    "meta_topic_over_network": Parameter(str, "map_meta_other"),
    "control_topic": Parameter(str, "control"),
    "position_local_robot_topic": Parameter(str, "slam_out_pose"),
    "position_other_robots_topic": Parameter(str, "position_other_robots"),
    "has_local_map": Parameter(bool, True),
    "exchange_position": Parameter(bool, False),
    "splitted": Parameter(bool, True),
    "split_size": Parameter(int, 2048, least=1, most=2048),
    "seconds_pub_timer": Parameter(int, 3, least=1),
    "seconds_send_timer": Parameter(int, 5, least=1),
    "seconds_recompute_transform": Parameter(int, 5, least=1, also=-1),
    "seconds_send_position": Parameter(int, 2, least=1),
    "seconds_meta_timer": Parameter(int, 5, least=1),
    "max_trans_robots": Parameter(float, -1.0, least=0.0, also=-1.0),
    "max_rotation_robots": Parameter(float, -1.0, least=0.0, also=-1.0),
    "debug": Parameter(bool, True),
    "log_path": Parameter(str, ""),
    "registration": Parameter(str, "correlation", choices=METHODS),
    "initial_poses": Parameter(dict, {}),
    "scan_topic": Parameter(str, ""),
    "body_radius": Parameter(float, USUAL_SIZE.body_radius, least=0.02, most=2.0),
    "largest_robot_radius": Parameter(float, USUAL_SIZE.largest_radius, least=0.02, most=5.0),
    "local_priority": Parameter(str, "evidence", choices=("strict", "evidence")),
    "topology": Parameter(str, "distributed", choices=("distributed", "centralized")),
    "base_station": Parameter(str, ""),
    "run": Parameter(str, ""),
}
"""Every parameter of the node."""

OF_THE_TEAM = ("body_radius", "largest_robot_radius")

WITHOUT_EFFECT: Dict[str, str] = {
    "local_map_metadata_topic": "the geometry is taken from every map itself, so a map may grow",
}
"""Accepted for compatibility; setting one gives one warning with this reason."""

OVER_NETWORK = (
    "map_topic_over_network",
    "meta_topic_over_network",
    "control_topic",
    "position_other_robots_topic",
)
"""Names of topics, each of a type of its own."""

TOPICS = ("local_map_topic", *OVER_NETWORK, "position_local_robot_topic", "scan_topic")

NOT_EMPTY = ("local_map_frame_id", "local_map_topic", *OVER_NETWORK, "position_local_robot_topic")


@dataclass(frozen=True)
class Options:
    """Checked parameters, with the names of PARAMETERS. Seconds, cells (max_trans_robots) and degrees as in the
    contract. What has no default follows from the robots; `options_of` takes usual ones where nobody says what they
    are."""

    robot_name: str
    body_radius: float
    largest_robot_radius: float
    robot_prefix: str = ""
    local_map_frame_id: str = "map"
    local_map_topic: str = "/map"
    local_map_metadata_topic: str = "/map_metadata"
    map_topic_over_network: str = "map_other"
    meta_topic_over_network: str = "map_meta_other"
    control_topic: str = "control"
    position_local_robot_topic: str = "slam_out_pose"
    position_other_robots_topic: str = "position_other_robots"
    has_local_map: bool = True
    exchange_position: bool = False
    splitted: bool = True
    split_size: int = 2048
    seconds_pub_timer: int = 3
    seconds_send_timer: int = 5
    seconds_recompute_transform: int = 5
    seconds_send_position: int = 2
    seconds_meta_timer: int = 5
    max_trans_robots: float = -1.0
    max_rotation_robots: float = -1.0
    debug: bool = True
    log_path: str = ""
    registration: str = "correlation"
    initial_poses: Mapping[str, Pose] = field(default_factory=dict)
    scan_topic: str = ""
    local_priority: str = "evidence"
    topology: str = "distributed"
    base_station: str = ""
    run: str = ""

    @property
    def boot(self) -> Optional[Boot]:
        """Names the own run, where it was given a name."""
        return _boot_of(self.run) if self.run else None

    @property
    def robot_size(self) -> RobotSize:
        """Of the robots of the team."""
        return RobotSize(self.body_radius, self.largest_robot_radius)

    @property
    def centralized(self) -> bool:
        """True if one base merges for all."""
        return self.topology == "centralized"

    @property
    def is_base(self) -> bool:
        """True if this is the base that merges for all."""
        return self.centralized and self.base_station == self.robot_name


def options_of(given: Mapping[str, Any], host_name: str) -> Options:
    """Options from the parameters that are set (unset ones are left out). OptionError names the first bad one."""
    unknown = sorted(set(given) - set(PARAMETERS))
    if unknown:
        raise OptionError(f"parameter {unknown[0]} is not known")
    values = {name: _checked(name, given[name]) for name in PARAMETERS if name in given}
    values["robot_name"] = values.get("robot_name") or host_name
    for name in OF_THE_TEAM:
        values.setdefault(name, PARAMETERS[name].default)
    for name in ("robot_name", "base_station"):
        if not re.fullmatch(r"[A-Za-z0-9_.\-]*", values.get(name, "")):
            raise OptionError(f"parameter {name} holds more than letters, digits and _.-: {values[name]!r}")
    values["initial_poses"] = _poses(values.get("initial_poses", {}))
    _settle_roles(values)
    options = Options(**values)
    _check_apart(options)
    return options


def warnings_of(given: Mapping[str, Any], host_name: str) -> List[str]:
    """One text for each parameter that was set, is none of which `options_of` complains, and has no effect."""
    reasons = dict(WITHOUT_EFFECT)
    if given.get("topology", "distributed") == "distributed" and given.get("base_station"):
        reasons["base_station"] = "topology is distributed"
    own, named = str(given.get("robot_name") or host_name), [str(robot) for robot in given.get("initial_poses", {})]
    if named and own not in named and given.get("has_local_map", True):
        reasons["initial_poses"] = (
            f"it has no pose of this robot, {own}, but of {', '.join(sorted(named))}: call it there as robot_name does"
        )
    return [f"parameter {name} has no effect: {reasons[name]}" for name in sorted(given) if name in reasons]


def _check_apart(options: Options) -> None:
    """rospy says nothing of two types on one topic, and neither arrives."""
    parameter_of: Dict[str, str] = {}
    for name in OVER_NETWORK:
        topic = getattr(options, name).strip("/")
        other = parameter_of.setdefault(topic, name)
        if other != name:
            raise OptionError(f"parameters {other} and {name} are both {topic!r}: each needs a topic of its own")


def _settle_roles(values: Dict[str, Any]) -> None:
    """Who is the base, in place. In the centralized topology a robot without a map can be nothing else."""
    if values.get("topology") != "centralized":
        return
    own, base = values["robot_name"], values.get("base_station", "")
    if values.get("has_local_map", True) and not base:
        raise OptionError("parameter base_station must name the base when topology is centralized")
    if not values.get("has_local_map", True) and base not in ("", own):
        raise OptionError(
            f"parameter has_local_map must be true on {own}: with topology centralized only the base, {base}, may be "
            f"without a map"
        )
    values["base_station"] = base or own


def _checked(name: str, value: Any) -> Any:
    parameter: Parameter = PARAMETERS[name]
    if parameter.kind is float and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if name in ("robot_name", "base_station") and type(value) is int:
        value = str(value)
    expected: Any = parameter.kind
    if type(value) is not expected:
        raise OptionError(f"parameter {name} must be of type {expected.__name__}, not {value!r}")
    if name in NOT_EMPTY and not value:
        raise OptionError(f"parameter {name} must not be empty")
    if name in TOPICS and value and not is_topic_name(value):
        raise OptionError(f"parameter {name} must be the name of a topic, not {value!r}")
    if name == "run" and value and _boot_of(value) is None:
        raise OptionError(f"parameter run must be a time as seconds.nanoseconds, not {value!r}")
    if name == "registration" and names_a_place(value):
        _check_method(value)
    elif parameter.choices and value not in parameter.choices:
        raise OptionError(f"parameter {name} must be one of {', '.join(parameter.choices)}, not {value!r}")
    if parameter.least is not None and not (value >= parameter.least or value == parameter.also):
        also = "" if parameter.also is None else f" or {parameter.also:g} for unlimited"
        if name == "seconds_recompute_transform":
            also = " or -1 for never"
        raise OptionError(f"parameter {name} must be at least {parameter.least:g}{also}, not {value:g}")
    if parameter.most is not None and value > parameter.most:
        raise OptionError(f"parameter {name} must be at most {parameter.most:g}, not {value:g}")
    if parameter.kind is float and not math.isfinite(value):
        raise OptionError(f"parameter {name} must be finite, not {value!r}")
    return value


def _boot_of(run: str) -> Optional[Boot]:
    found = re.fullmatch(r"(\d{1,10})\.(\d{9})", run)
    boot = found and (int(found[1]), int(found[2]))
    return boot if boot and NO_BOOT < boot < (2**32, 0) else None


def _check_method(place: str) -> None:
    try:
        method_of(place)
    except PlaceError as error:
        raise OptionError(f"parameter registration: {error}") from error


def _poses(given: Mapping[str, Any]) -> Dict[str, Pose]:
    poses = {}
    for robot, pose in given.items():
        try:
            poses[str(robot)] = pose_of(pose)
        except (TypeError, ValueError) as error:
            raise OptionError(
                f"parameter initial_poses/{robot}: expected [x, y, yaw] in metres and radians, not {pose!r}"
            ) from error
    return poses
