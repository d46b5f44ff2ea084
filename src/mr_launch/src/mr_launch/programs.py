"""The programs a team needs, found before anything starts."""

from __future__ import annotations

import random
import shutil
import socket
from itertools import islice
from pathlib import Path
from typing import Sequence

from mr_launch.errors import UserError
from mr_launch.isolation import search_path

LEAST_PORT = 12000  # above those of masters that people start by hand
CLIENT_PORTS = Path("/proc/sys/net/ipv4/ip_local_port_range")  # ip(7)
PROGRAMS = {  # name in Plan.programs: (package, executable)
    "radio": ("adhoc_communication", "radio"),
    "team_key": ("adhoc_communication", "team_key"),
    "world": ("mr_sim", "world"),
}
NODES = (
    ("adhoc_communication", "adhoc_communication"),
    ("map_merger", "map_merger"),
    ("explorer", "explorer"),
    ("mr_sim", "robot"),
    ("mr_launch", "monitor"),
    ("mr_launch", "record"),
    ("rosbag", "record"),
)
SLAM = {  # value of --slam: (package, executable)
    "ours": ("mr_robot", "slam"),
    "gmapping": ("gmapping", "slam_gmapping"),
    "slam_toolbox": ("slam_toolbox", "async_slam_toolbox_node"),
    "hector": ("hector_mapping", "hector_mapping"),
}
NAVIGATION = {
    "ours": ("mr_robot", "move_base"),
    "move_base": ("move_base", "move_base"),
    "move_base_flex": ("mbf_costmap_nav", "mbf_costmap_nav"),
}
# packages of this repository
OWN = ("adhoc_communication", "explorer", "map_merger", "mr_launch", "mr_robot", "mr_sim")
PLAYED = (("rosbag", "play"), ("mr_launch", "replay_monitor"))
COMPUTING = {  # value of --compute of the replay: what it needs
    "map_merger": (("map_merger", "map_merger"), ("mr_launch", "record"), ("rosbag", "record")),
    "explorer": (
        ("explorer", "explorer"),
        ("mr_launch", "replayed_navigation"),
        ("mr_launch", "record"),
        ("rosbag", "record"),
    ),
}
SYSTEM = ("roslaunch", "ip", "unshare", "nsenter", "setpriv")


def find_programs(slam: str, navigation: str) -> dict[str, str]:
    """Paths of all programs that the runner starts itself. `slam`, `navigation`: names, or launch files of one's own.
    Raises UserError that names every missing one."""
    wanted = [*PROGRAMS.values(), *NODES]
    wanted += [known[name] for known, name in ((SLAM, slam), (NAVIGATION, navigation)) if name in known]
    _refuse_missing(wanted)
    return {**{key: find_executable(*program) or "" for key, program in PROGRAMS.items()}, **_system_programs()}


def find_played(compute: Sequence[str]) -> dict[str, str]:
    """The same for a replay; `compute`: nodes that run again."""
    _refuse_missing([*PLAYED, *(program for node in compute for program in COMPUTING[node])])
    return _system_programs()


def _refuse_missing(wanted: Sequence[tuple[str, str]]) -> None:
    missing = sorted({(package, name) for package, name in wanted if not find_executable(package, name)})
    if missing:
        names = ", ".join("/".join(entry) for entry in missing)
        if any(package in OWN for package, _ in missing):
            raise UserError(f"not built: {names}; run 'make build' and source the setup.sh of the build")
        raise UserError(f"not installed: {names}; install it, or leave out --slam and --navigation")


def _system_programs() -> dict[str, str]:
    paths = {}
    for name in SYSTEM:
        found = shutil.which(name, path=search_path(""))  # the system's, whatever else is on PATH
        if not found:
            raise UserError(f"the program {name} is missing; run tools/install_dependencies")
        paths[name] = found
    return paths


def find_executable(package: str, name: str) -> str | None:
    """Path of ``rosrun package name``, None if there is none."""
    from roslib.packages import find_node  # a ROS library, needed only here
    from rospkg import ResourceNotFound

    try:
        found = find_node(package, name)
    except ResourceNotFound:
        return None
    return found[0] if found else None


def free_ports(count: int) -> list[int]:
    """TCP ports that nobody uses at this moment, if possible below those that the system gives to clients: such a one
    might be taken by a node before the master that it is meant for listens. Raises UserError if there are too few."""
    beyond = _first_client_port()
    candidates = range(LEAST_PORT, beyond if beyond > LEAST_PORT else 65536)
    ports = list(islice(filter(_is_free, random.sample(candidates, len(candidates))), count))
    if len(ports) < count:
        raise UserError(
            f"fewer than {count} of the TCP ports from {candidates.start} to {candidates.stop - 1} are free"
        )
    return ports


def _first_client_port() -> int:
    try:
        return int(CLIENT_PORTS.read_text(encoding="ascii").split()[0])
    except (OSError, ValueError, IndexError):
        return 32768


def _is_free(port: int) -> bool:
    with socket.socket() as one:
        try:
            one.bind(("localhost", port))
        except OSError:
            return False
    return True
