"""A mission of the team runner that runs now, seen from outside: its processes, how to hurt them."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import socket
import subprocess
import time
from pathlib import Path
from typing import Iterator, NamedTuple

from mr_launch.isolation import PRIVATE_MOUNT
from mr_launch.plan import RADIO_CONTROL

CLOCK_OFFSET = "/robot/clock_offset"  # topic of a simulated robot
PATIENCE = 5.0  # s for an answer of the radio daemon
ANSWER_OCTETS = 1 << 16
_NODE = re.compile(r"__log:=\S*/logs/(?P<robot>[^/\s]+)/nodes/(?P<node>\w+?)(?:-\d+)?\.log")
# Stays as long as its nodes, to start them again.
_LAUNCH = re.compile(r"/(?P<node>roslaunch) .*\blog_path:=\S*/logs/(?P<robot>[^/\s]+)(?= |$)")


class Node(NamedTuple):
    robot: str
    name: str
    pid: int


class RunningMission:
    """`process`: that was started, in whose mount namespace the output folder `out` is."""

    def __init__(self, process: subprocess.Popen[bytes], out: Path) -> None:
        self.process = process
        self.out = out
        self._offsets: dict[str, float] = {}

    def path(self, name: str) -> Path:
        """A file of the output folder, as this process reaches it."""
        return Path(f"/proc/{self.process.pid}/root{self.out}/{name}")

    def processes(self) -> Iterator[tuple[int, str]]:
        """Process id and command line of all that has to do with the output folder."""
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                command = Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
            except OSError:
                continue
            if str(self.out) in command and int(pid) != os.getpid():
                yield int(pid), command

    def nodes(self) -> list[Node]:
        """Those of all robots; master and roslaunch are two."""
        found = []
        for pid, command in self.processes():
            match = _NODE.search(command) or _LAUNCH.search(command)
            if match and f"{self.out}/" in match[0]:
                found.append(Node(match["robot"], match["node"], pid))
        return found

    def kill(self, robot: str, name: str) -> bool:
        """As by a fault of the program; False if it does not run."""
        pids = [node.pid for node in self.nodes() if (node.robot, node.name) == (robot, name)]
        for pid in pids:
            os.kill(pid, signal.SIGKILL)
        return bool(pids)

    def tell_radio(self, command: str, robot: str) -> bool:
        """A line for the control socket of the radio daemon; False unless it knows the robot and has carried it out."""
        with self._radio() as control:
            return carried_out(control, command, robot)

    def delivered(self, robot: str) -> int:
        """How many times a frame of the robot has come to another one so far."""
        with self._radio() as control:
            control.send(b"statistics\n")
            return int(json.loads(control.recv(ANSWER_OCTETS))["robots"][robot]["delivered"])

    @contextlib.contextmanager
    def _radio(self) -> Iterator[socket.socket]:
        init = json.loads(self.path("team.json").read_text())["init"]
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as control:
            control.settimeout(PATIENCE)
            control.connect(f"/proc/{init}/root{PRIVATE_MOUNT}/{RADIO_CONTROL}")
            yield control

    def enter(self, robot: str, *command: str) -> str:
        """Output of a command in the place of a robot; nothing if it takes a minute."""
        inside = ["nsenter", "--target", str(self.process.pid), "--mount", "--"]
        words = [*inside, "rosrun", "mr_launch", "enter", "--team", str(self.out), robot, *command]
        try:
            done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
        except subprocess.TimeoutExpired:
            return ""
        return done.stdout + done.stderr

    def set_clock(self, robot: str, offset: float) -> bool:
        """Sets the clock of a simulated robot `offset` s ahead of that of the world; False if it does not go that much
        otherwise than before."""
        change = offset - self._offsets.get(robot, 0.0)
        before, begin = self._clock_of(robot), time.monotonic()
        words = ("timeout", "20", "rostopic", "pub", "-1", CLOCK_OFFSET, "std_msgs/Float64", f"data: {offset:g}")
        self.enter(robot, *words)
        self._offsets[robot] = offset
        after, passed = self._clock_of(robot), time.monotonic() - begin
        return None not in (before, after) and has_jumped(after - before, passed, change)  # type: ignore[operator]

    def _clock_of(self, robot: str) -> float | None:
        text = self.enter(robot, "timeout", "20", "rostopic", "echo", "-n1", "/clock/clock")
        found = re.search(r"secs: (\d+)\s+nsecs:\s+(\d+)", text)
        return int(found[1]) + int(found[2]) / 1e9 if found else None


def has_jumped(moved: float, passed: float, change: float) -> bool:
    """Whether a clock that went on by `moved` s while `passed` s went by was set by `change` s; half of it is allowed
    for what a busy computer takes to look."""
    return abs(moved - passed - change) < 0.5 * abs(change)


def carried_out(control: socket.socket, command: str, robot: str) -> bool:
    """Tells the radio daemon on the other end `command robot`. It answers a line only if it refuses it, and takes up
    whom it does not know: so it is asked for its statistics, which name the robots, before and after."""
    control.send(b"statistics\n")
    if robot not in json.loads(control.recv(ANSWER_OCTETS))["robots"]:
        return False
    control.send(f"{command} {robot}\nstatistics\n".encode())
    return control.recv(ANSWER_OCTETS).startswith(b"{")
