"""The runner's eye on one robot: gathers what the nodes publish and reports it as JSON lines. Knows no ROS."""

from __future__ import annotations

import json
import select
import socket
from typing import Any, Iterable, Mapping

from mr_grid import Pose
from mr_measures.record.beliefs import Beliefs

PARTS = ("adhoc_communication", "map", "map_merger", "explorer", "move_base")


class Digest:
    """Collects the news of one robot; ``report`` gives what changed into the runner's RobotReport."""

    def __init__(self, robot: str) -> None:
        self.robot = robot
        self._values: dict[str, Any] = {}
        self._missing = set(PARTS)
        self._merge_times: dict[str, float] = {}
        self._beliefs = Beliefs()
        self._merges: list[dict[str, Any]] = []

    def seen(self, part: str) -> None:
        """This part of the robot is up."""
        self._missing.discard(part)

    @property
    def missing(self) -> list[str]:
        return [part for part in PARTS if part in self._missing]

    def set(self, **values: Any) -> None:
        self._values.update(values)

    def merged(self, robots: Iterable[str], now: float) -> None:
        """Robots whose transform is known at simulation time ``now`` (s); the first time of each is kept."""
        names = sorted(set(robots) - {self.robot})
        for name in names:
            self._merge_times.setdefault(name, now)
        self._values["merged"] = names

    def believes(self, transforms: Mapping[str, Pose], now: float) -> None:
        """All transforms to other robots' maps that are believed at simulation time ``now`` (s)."""
        for name, transform in self._beliefs.changes(transforms):
            place = None if transform is None else [round(value, 5) for value in transform]
            self._merges.append({"with": name, "at": now, "transform": place})
        self._values["merges"] = self._merges

    def report(self, now: float) -> dict[str, Any]:
        return {
            "robot": self.robot,
            "time": now,
            "missing": self.missing,
            "merge_times": self._merge_times,
            **self._values,
        }


class RunnerLink:
    """The monitor's end of the socket. ``requests`` raises ConnectionError when the runner is gone."""

    def __init__(self, path: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._socket.connect(path)
        self._buffer = b""

    def send(self, report: dict[str, Any]) -> None:
        self._socket.sendall(json.dumps(report).encode() + b"\n")

    def requests(self, seconds: float) -> list[dict[str, Any]]:
        """Requests that arrive within ``seconds``; returns at the first."""
        if not select.select([self._socket], [], [], seconds)[0]:
            return []
        data = self._socket.recv(65536)
        if not data:
            raise ConnectionError("the runner is gone")
        *lines, self._buffer = (self._buffer + data).split(b"\n")
        return [json.loads(line) for line in lines]
