"""Missions of the team runner for several tests: started, disturbed, looked into."""

import os
import signal
import subprocess
import time
from pathlib import Path
from typing import List, NamedTuple

LIMIT_S = 400
TOPOLOGIES = ("distributed", "centralized")
LOOK = ("timeout", "20", "rostopic", "echo", "-n1")
BEGINS = ("timeout", "20", "rostopic", "echo", "-n1", "--filter", "m.state==1")
KILLED = {
    "distributed": {"robot_0": ("explorer", "adhoc_communication"), "robot_1": ("map_merger",)},
    "centralized": {"robot_1": ("slam",)},
}


class Mission(NamedTuple):
    """`visit`: exit code and output of the doctor; `orders`: answers of the base's mission control."""

    code: int
    output: str
    out: Path
    visit: tuple = ()
    orders: str = ""


def run_of(topology: str, out: Path) -> Mission:
    command = ["rosrun", "mr_launch", "team", "--world", "small8x8", "--robots", "2", "--loss", "0.1", "--seed", "3"]
    disturbed = topology == "distributed"
    told = out.with_name(f"{out.name}.log")
    with told.open("wb") as log:
        run = subprocess.Popen(
            [*command, "--topology", topology, "--duration", "300", "--out", str(out), "--respawn"],
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
        )
    try:
        while not processes_of(f"{out}/logs/robot_0/nodes/explorer-"):  # looking costs less than to enter
            assert run.poll() is None, told.read_text()
            time.sleep(0.1)
        while "state: 1" not in enter(out, "robot_0", *BEGINS, "/explorer/state").stdout:  # the runner tells it later
            assert run.poll() is None, told.read_text()
        visit, orders = (disturb(out), "") if disturbed else ((), order(out))
        run.wait(timeout=LIMIT_S)
    finally:
        run.terminate()
    return Mission(run.returncode, told.read_text(), out, visit, orders)


def order(out: Path) -> str:
    """The base pauses both robots, sees that they are paused, and lets them go on; then robot_1 loses its slam."""
    answers = enter(out, "base", "rosservice", "call", "/mission_control/pause").stdout
    for _ in range(20):
        team = enter(out, "base", *LOOK, "/mission_control/team").stdout
        if team.count('text: "is paused"') == 2:
            break
    answers += team + enter(out, "base", "rosservice", "call", "/mission_control/resume").stdout
    kill(out, "robot_1", "slam")
    return answers


def disturb(out: Path) -> tuple:
    """The doctor's visit to robot_0, while robot_1 loses its map_merger; then the other nodes are killed. Until then
    robot_1 is paused, so that the mission lasts, however long the visit takes on a busy computer."""
    enter(out, "robot_1", "rosservice", "call", "/explorer/pause")
    kill(out, "robot_1", "map_merger")
    visit = enter(out, "robot_0", "rosrun", "mr_launch", "doctor", "--peers", "robot_1", "--seconds", "2")
    kill(out, "robot_0", "explorer")
    kill(out, "robot_0", "adhoc_communication")
    enter(out, "robot_1", "rosservice", "call", "/explorer/resume")
    return visit.returncode, visit.stdout + visit.stderr


def enter(out: Path, robot: str, *command: str) -> "subprocess.CompletedProcess[str]":
    words = ["rosrun", "mr_launch", "enter", "--team", str(out), robot, *command]
    return subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)


def kill(out: Path, robot: str, node: str) -> None:
    (pid,) = processes_of(f"{out}/logs/{robot}/nodes/{node}-")
    os.kill(pid, signal.SIGKILL)


def processes_of(words: str) -> List[int]:
    """Processes with these words in their command line."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            command = Path(f"/proc/{pid}/cmdline").read_bytes().decode(errors="replace")
        except OSError:
            continue
        if words in command:
            found.append(int(pid))
    return found
