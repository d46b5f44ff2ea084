"""What a mission could leave on the machine, looked for when it is over."""

from __future__ import annotations

import contextlib
import os
import time
from pathlib import Path

from mr_launch.soak.running import RunningMission

PATIENCE = 15.0  # s for the kernel to take down namespaces


class Leftovers:
    """Remembers the network namespaces of a mission while it runs."""

    def __init__(self, mission: RunningMission) -> None:
        self._mission = mission
        self._own = {_network("self")}
        self._seen: set[str] = set()
        self._temporary = set(_temporary())

    def look(self) -> None:
        for pid, _ in self._mission.processes():
            with contextlib.suppress(OSError):
                self._seen.add(_network(str(pid)))
        self._seen -= self._own

    def found(self) -> list[str]:
        """Processes, network namespaces, mounts and temporary folders; empty as soon as nothing is left."""
        end = time.monotonic() + PATIENCE
        while True:
            left = self._left()
            if not left or time.monotonic() > end:
                return left
            time.sleep(0.2)

    def _left(self) -> list[str]:
        left = [f"process {pid}: {command[:80]}" for pid, command in self._mission.processes()]
        for pid in filter(str.isdigit, os.listdir("/proc")):
            with contextlib.suppress(OSError):
                if _network(pid) in self._seen:
                    left.append(f"process {pid} in a network namespace of the mission")
        mounts = Path("/proc/self/mounts").read_text().splitlines()
        left += [f"mount {line}" for line in mounts if str(self._mission.out) in line]
        return left + [f"folder {name}" for name in set(_temporary()) - self._temporary]


def _network(pid: str) -> str:
    return os.readlink(f"/proc/{pid}/ns/net")


def _temporary() -> list[str]:
    return [str(path) for path in Path("/tmp").glob("mr_launch-*")]
