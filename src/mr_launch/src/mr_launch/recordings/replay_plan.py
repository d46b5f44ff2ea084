"""Everything that is decided before a replay starts: a plain value that goes to its first process as JSON."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

from mr_launch.plan import ros_environment

SAVE = "map_merger"  # its maps are kept


@dataclass(frozen=True)
class PlayedRobot:
    """`bag`: what is played; `end`: of it on the robot's own clock, s; `arguments`: more of replayed_robot.launch."""

    name: str
    port: int
    bag: str
    end: float
    arguments: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class ReplayPlan:
    """`seconds`: of recorded time; `rate`: recorded over real seconds; `compute`: nodes that run again."""

    robots: list[PlayedRobot]
    out: str
    isolation: str
    programs: dict[str, str]
    seconds: float
    rate: float = 1.0
    compute: list[str] = field(default_factory=list)
    private: str = ""  # folder for sockets

    def socket(self, name: str) -> str:
        return str(Path(self.private) / name)

    def log_folder(self, robot: str = "") -> Path:
        return Path(self.out) / "replay_logs" / robot  # "logs" is that of a mission

    def to_json(self) -> str:
        return json.dumps(asdict(self))

    @staticmethod
    def from_json(text: str) -> ReplayPlan:
        values = json.loads(text)
        values["robots"] = [PlayedRobot(**robot) for robot in values["robots"]]
        return ReplayPlan(**values)


def environment(plan: ReplayPlan, robot: PlayedRobot) -> dict[str, str]:
    """ROS variables of one robot."""
    return ros_environment(robot.port, plan.socket(f"ros_home/{robot.name}"), str(plan.log_folder(robot.name)))


def launch_command(plan: ReplayPlan, robot: PlayedRobot) -> list[str]:
    """roslaunch with a master of its own: the player, and the nodes that run again."""
    arguments = {
        "robot_name": robot.name,
        "bag": robot.bag,
        "rate": f"{plan.rate:g}",
        "report_socket": plan.socket("reports"),
        **{name: "true" for name in plan.compute},
        "output_bag": str(Path(plan.out) / robot.name / f"{robot.name}.bag") if plan.compute else "",
        "log_path": str(plan.log_folder(robot.name)) if plan.compute else "",
        **robot.arguments,
    }
    command = [plan.programs["roslaunch"], "-p", str(robot.port), "--run_id", "nodes", "mr_launch"]
    return [*command, "replayed_robot.launch", *(f"{name}:={value}" for name, value in arguments.items())]
