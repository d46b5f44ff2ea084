"""A mission of the team runner that runs now, seen from outside: its processes, how to hurt them."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
from pathlib import Path
from typing import Iterator, NamedTuple

from mr_launch.isolation import PRIVATE_MOUNT
from mr_launch.plan import RADIO_CONTROL

_NODE = re.compile(r"__log:=\S*/logs/(?P<robot>[^/\s]+)/nodes/(?P<node>\w+?)(?:-\d+)?\.log")


class Node(NamedTuple):
    robot: str
    name: str
    pid: int


class RunningMission:
    """`process`: that was started, in whose mount namespace the output folder `out` is."""

    def __init__(self, process: subprocess.Popen[bytes], out: Path) -> None:
        self.process = process
        self.out = out

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
        """Those of all robots; the master is one."""
        found = []
        for pid, command in self.processes():
            match = _NODE.search(command)
            if match and f"{self.out}/" in match[0]:
                found.append(Node(match["robot"], match["node"], pid))
        return found

    def kill(self, robot: str, name: str) -> bool:
        """As by a fault of the program; False if it does not run."""
        pids = [node.pid for node in self.nodes() if (node.robot, node.name) == (robot, name)]
        for pid in pids:
            os.kill(pid, signal.SIGKILL)
        return bool(pids)

    def tell_radio(self, line: str) -> bool:
        """A line for the control socket of the radio daemon."""
        init = json.loads(self.path("team.json").read_text())["init"]
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as control:
            control.connect(f"/proc/{init}/root{PRIVATE_MOUNT}/{RADIO_CONTROL}")
            control.send(line.encode() + b"\n")
        return True

    def enter(self, robot: str, *command: str) -> str:
        """Output of a command in the place of a robot; nothing if it takes a minute."""
        inside = ["nsenter", "--target", str(self.process.pid), "--mount", "--"]
        words = [*inside, "rosrun", "mr_launch", "enter", "--team", str(self.out), robot, *command]
        try:
            done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
        except subprocess.TimeoutExpired:
            return ""
        return done.stdout + done.stderr

    def jump_clock(self, robot: str, seconds: float) -> bool:
        """One reading of the time that is wrong by so much, so that it jumps there and back; False without a clock."""
        log = self.enter(robot, "timeout", "5", "rostopic", "echo", "-n1", "/clock/clock")
        found = re.search(r"secs: (\d+)", log)
        if found:
            moved = max(0, int(found[1]) + round(seconds))
            self.enter(robot, "timeout", "5", "rostopic", "pub", "-1", "/clock", "rosgraph_msgs/Clock",
                       f"clock: {{secs: {moved}, nsecs: 0}}")  # fmt: skip
        return found is not None
