"""Everything that is decided before the first process starts: a plain value that goes to the inner process as JSON."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import yaml  # type: ignore[import-untyped]

from mr_grid import Pose
from mr_launch import isolation
from mr_launch.arguments import Options

FIRST_PORT = 11311
RADIO_INTERFACE = "radio0"
RADIO_CONTROL = "radio"  # control socket of the radio daemon
SLOWEST_RADIO = 0.001  # the least real-time factor that the radio daemon takes
BASE = "base"  # name of the base station of a centralized team
PLAN_FILE = "plan.json"  # in the output folder, from the start: what the mission was to be
TRUTH_FILE = "truth.pickle"  # what maps are compared with, in the private folder


@dataclass(frozen=True)
class RobotPlan:
    """One robot of the team. ``start`` is its true pose in the world frame: x, y in m, yaw in rad."""

    name: str
    index: int
    port: int
    start: Pose
    preset: str = "pioneer"  # what the robot is: its name in Plan.presets, or of one that comes with mr_robot

    @property
    def air(self) -> str:
        """The radio's end of the robot's cable. An index, because interface names end at 15 characters."""
        return f"air{self.index}"


@dataclass(frozen=True)
class Plan:
    """A checked mission: options, world file, robots, programs and the kind of isolation."""

    options: Options
    world: str
    robots: list[RobotPlan]
    out: str
    isolation: str
    programs: dict[str, str] = field(default_factory=dict)  # name -> path, see programs.PROGRAMS
    private: str = ""  # folder for sockets
    base: RobotPlan | None = None  # the base station of a centralized team; it has no body
    presets: dict[str, str] = field(default_factory=dict)  # name -> text of the preset, made from the world's model

    @property
    def hosts(self) -> list[RobotPlan]:
        """All that have a master and a radio of their own."""
        return [*self.robots, *([self.base] if self.base else [])]

    def robot_folder(self, robot: RobotPlan) -> Path:
        return Path(self.out) / robot.name

    def preset_file(self, name: str) -> str:
        """As an argument of robot.launch."""
        return str(Path(self.out) / "robots" / f"{name}.yaml") if name in self.presets else name

    @property
    def team(self) -> str:
        """The kinds of robots, as an argument of robot.launch."""
        return ",".join(dict.fromkeys(self.preset_file(robot.preset) for robot in self.robots))

    def scan_topic(self, robot: RobotPlan) -> str:
        """Of the ranger by which the robot finds its way, as its preset has it; empty without one of this plan."""
        preset = yaml.safe_load(self.presets.get(robot.preset, "")) or {}
        return str(preset.get("topics", {}).get("scan", ""))

    def log_folder(self, robot: RobotPlan | None = None) -> Path:
        logs = Path(self.out) / "logs"
        return logs / robot.name if robot else logs

    def socket(self, name: str) -> str:
        return str(Path(self.private) / name)

    def to_json(self) -> str:
        return json.dumps(asdict(self))

    @staticmethod
    def from_json(text: str) -> Plan:
        values: dict[str, Any] = json.loads(text)
        values["options"] = Options(**values["options"])
        values["robots"] = [_robot_from(robot) for robot in values["robots"]]
        values["base"] = _robot_from(values["base"]) if values["base"] else None
        return Plan(**values)


def _robot_from(values: dict[str, Any]) -> RobotPlan:
    return RobotPlan(**dict(values, start=Pose(*values["start"])))


def robot_environment(plan: Plan, robot: RobotPlan) -> dict[str, str]:
    """ROS variables of one robot."""
    return ros_environment(robot.port, plan.socket(f"ros_home/{robot.name}"), str(plan.log_folder(robot)))


def ros_environment(port: int, home: str, logs: str) -> dict[str, str]:
    """In a network namespace of its own every master has the usual port."""
    return {
        "ROS_MASTER_URI": f"http://localhost:{port}",
        "ROS_HOSTNAME": "localhost",
        "ROS_HOME": home,
        "ROS_LOG_DIR": logs,
    }


def link_commands(robot: RobotPlan, holder: int) -> list[list[str]]:
    """Commands, run in the radio's namespace, that lay a cable to the namespace held by process ``holder``."""
    inside = namespace_prefix(holder)
    return [
        ["ip", "link", "add", robot.air, "type", "veth", "peer", "name", RADIO_INTERFACE, "netns", str(holder)],
        ["ip", "link", "set", robot.air, "up"],
        [*inside, "ip", "link", "set", "lo", "up"],
        [*inside, "ip", "link", "set", RADIO_INTERFACE, "up"],
    ]


def namespace_prefix(holder: int | None) -> list[str]:
    return ["nsenter", "--target", str(holder), "--net", "--"] if holder is not None else []


class Walls(NamedTuple):
    """A floor plan for the radio: PGM file, m per pixel, lower left corner (m, world frame)."""

    file: str
    resolution: float
    origin: tuple[float, float]


def radio_command(plan: Plan, walls: Walls | None = None) -> list[str]:
    """The radio daemon on the other ends of all cables, or as a hub on a Unix socket."""
    options = plan.options
    command = [plan.programs["radio"]]
    if plan.isolation == isolation.HUB:
        command += ["--hub", plan.socket("hub")]
    else:
        for robot in plan.hosts:
            command += ["--interface", f"{robot.name}={robot.air}"]
    command += ["--range", f"{options.range:g}", "--loss", f"{options.loss:g}", "--seed", str(options.seed)]
    # As fast as it goes is a factor that nobody knows in advance.
    command += ["--rtf", f"{max(options.rtf, SLOWEST_RADIO) if options.rtf else 1.0:g}"]
    if walls is not None:
        command += ["--walls", walls.file, "--walls-resolution", f"{walls.resolution:.6f}"]
        command += ["--walls-origin", "{:.6f},{:.6f}".format(*walls.origin)]
        command += ["--wall-attenuation", f"{options.wall_attenuation:g}"]
    command += ["--control", plan.socket(RADIO_CONTROL), "--statistics", str(Path(plan.out) / "radio.json")]
    return command


def world_command(plan: Plan) -> list[str]:
    options = plan.options
    command = [plan.programs["world"], "--world", plan.world, "--socket", plan.socket("world")]
    command += ["--robots", str(len(plan.robots)), "--rtf", f"{options.rtf:g}", "--seed", str(options.seed)]
    command += ["--odometry", options.odometry]
    command += ["--radio-control", plan.socket(RADIO_CONTROL), "--trace", str(Path(plan.out) / "truth.csv")]
    return command


def truth_command(plan: Plan) -> list[str]:
    """Computes the reference of the world's figures beside the start of the nodes."""
    python = [sys.executable, "-m", "mr_launch.world"]
    return ["nice", *python, plan.world, str(len(plan.robots)), plan.socket(TRUTH_FILE)]


def page_socket(plan: Plan) -> str:
    """To which the robots tell what the team's page shows; empty without one."""
    return plan.socket("page") if plan.options.page else ""


def page_command(plan: Plan, descriptor: int) -> list[str]:
    """The server of the team's page, on a listening socket of the machine's own network."""
    command = [sys.executable, "-m", "mr_page.team_page", "--descriptor", str(descriptor)]
    title = f"{plan.options.world}, {len(plan.robots)} robot{'s' if len(plan.robots) > 1 else ''}"
    return [*command, "--feeds", page_socket(plan), "--radio", plan.socket(RADIO_CONTROL), "--title", title]


def key_command(plan: Plan) -> list[str]:
    """Makes the key with which the robots of this team seal their frames."""
    return [plan.programs["team_key"], "create", key_file(plan)]


def key_file(plan: Plan) -> str:
    """Kept with the results, so that a robot can be added and captured frames be read; empty for open frames."""
    return "" if plan.options.open else str(Path(plan.out) / "team.key")


def initial_poses(plan: Plan) -> str:
    """Start poses of the whole team for map_merger, as YAML: x, y in m and yaw in rad, in the world frame."""
    return json.dumps({robot.name: [round(value, 6) for value in robot.start] for robot in plan.robots})


def launch_command(plan: Plan, robot: RobotPlan, boot: int = 1) -> list[str]:
    """roslaunch with a master of its own: robot.launch, the monitor and the bag recorder of one robot. `boot`: how
    often it has been started with this; each time it has a map frame of its own, and so a bag."""
    if robot == plan.base:
        return _base_command(plan, robot)
    options = plan.options
    arguments = {
        "robot_name": robot.name,
        "interface": _interface(plan),
        "key_file": key_file(plan),
        "robot": plan.preset_file(robot.preset),
        "team": plan.team,
        "simulated": "true",
        "world_socket": plan.socket("world"),
        "scan_topic": plan.scan_topic(robot),
        "slam": options.slam,
        "navigation": options.navigation,
        "frontier_selection": str(options.strategy),
        "time_limit": str(options.time_limit),
        "distance_limit": str(options.distance_limit),
        "initial_poses": initial_poses(plan) if options.initial_poses else "{}",
        "topology": options.topology,
        "base_station": plan.base.name if plan.base else "",
        "log_path": str(plan.log_folder(robot)),
        "autostart": "false",
        "report_socket": plan.socket("reports"),
        "start_pose": " ".join(f"{value:g}" for value in robot.start),
        "truth_file": plan.socket(TRUTH_FILE),
        "seed": str(options.seed + robot.index),
        "page_team": page_socket(plan),
        "respawn": _word(options.respawn),
        "bag": str(plan.robot_folder(robot) / bag_name(robot.name, boot)) if options.bag else "",
    }
    return _roslaunch(plan, robot, "team_robot.launch", arguments)


def bag_name(robot: str, boot: int = 1) -> str:
    return f"{robot}.bag" if boot == 1 else f"{robot}_{boot}.bag"


def _base_command(plan: Plan, base: RobotPlan) -> list[str]:
    arguments = {
        "name": base.name,
        "interface": _interface(plan),
        "key_file": key_file(plan),
        "team": plan.team,
        "initial_poses": initial_poses(plan) if plan.options.initial_poses else "{}",
        "log_path": str(plan.log_folder(base)),
        "report_socket": plan.socket("reports"),
        "page_team": page_socket(plan),
        "respawn": _word(plan.options.respawn),
    }
    return _roslaunch(plan, base, "team_base_station.launch", arguments)


def _word(value: bool) -> str:
    """As a launch file reads it."""
    return "true" if value else "false"


def _interface(plan: Plan) -> str:
    return f"hub:{plan.socket('hub')}" if plan.isolation == isolation.HUB else RADIO_INTERFACE


def _roslaunch(plan: Plan, host: RobotPlan, file: str, arguments: dict[str, str]) -> list[str]:
    command = [plan.programs["roslaunch"], "-p", str(host.port), "--run_id", "nodes", "mr_launch", file]
    return command + [f"{name}:={value}" for name, value in arguments.items()]


def base_position(base: RobotPlan) -> str:
    """Command for the radio: where the base stands, which the world does not know."""
    return f"position {base.name} {base.start[0]:.3f} {base.start[1]:.3f}\n"
