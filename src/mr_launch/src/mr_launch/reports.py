"""What the monitors of the robots tell the runner: JSON lines over a Unix socket, requests back the same way."""

from __future__ import annotations

import contextlib
import json
import os
import selectors
import socket
import statistics
from dataclasses import dataclass, field
from typing import Any

from mr_launch.robot_log import RobotLog, Sample

MAXIMUM_LINE = 1 << 20  # octets; a monitor that sends more without a line end is cut off

STATES = ("starting", "exploring", "waiting", "returning", "finished")
WAITING, FINISHED = 2, 4
PAUSED = "is paused"  # explorer.orders.PAUSED: what a paused robot says, which waits


@dataclass
class RobotReport:
    """Latest news of one robot. Times in s of simulation time, positions in m in the robot's ``map`` frame."""

    robot: str
    time: float = 0.0
    missing: list[str] = field(default_factory=lambda: ["monitor"])
    started: bool = False
    start_error: str = ""
    state: int = 0
    text: str = ""
    exploration_finished: bool = False
    exploration_time: float = 0.0
    goal: tuple[float, float] | None = None
    frontiers: int = 0
    unreachable: int = 0
    goals: int = 0
    goals_reached: int = 0
    goals_failed: int = 0
    auctions: int = 0
    auctions_uncompleted: int = 0
    bids: int = 0
    explored: float = 0.0  # m^2 of free space in the global map
    own: float = 0.0  # m^2 of free space in its own map
    coverage: float | None = None
    map_begun: list[int] | None = None  # load time of its own map: s, ns
    map_stamp: float = 0.0  # of its own map
    neighbors: list[str] = field(default_factory=list)
    merged: list[str] = field(default_factory=list)
    sees_merges: bool = False
    start_time: float = 0.0
    radio: dict[str, Any] = field(default_factory=dict)
    saved: str = ""

    @property
    def state_name(self) -> str:
        if self.state == WAITING and self.text == PAUSED:
            return "paused"
        return STATES[self.state] if self.state < len(STATES) else str(self.state)

    def sample(self) -> Sample:
        sent = {name: int(self.radio.get(f"{name}_sent", 0)) for name in ("bytes", "frames")}
        return Sample(
            self.time, self.explored, self.own, **sent, bids=self.bids, state=self.state,
            neighbors=tuple(self.neighbors),
        )  # fmt: skip

    def update(self, values: dict[str, Any]) -> None:
        """Take over known fields; an unknown one is a monitor of another version and is ignored."""
        for name, value in values.items():
            if name in self.__dataclass_fields__ and name != "robot":
                setattr(self, name, value)


class ReportServer:
    """Accepts the monitors of all robots and of the base station and keeps the latest report of each, and a log. Never
    blocks longer than asked."""

    def __init__(self, path: str, robots: list[str], base: str = "") -> None:
        """`base`: name of the base station; empty: there is none."""
        self.reports = {name: RobotReport(name) for name in robots}
        self._bases = {base: RobotReport(base)} if base else {}
        self.logs = {name: RobotLog() for name in [*robots, *self._bases]}
        self._links: dict[str, socket.socket] = {}
        self._buffers: dict[socket.socket, bytes] = {}
        self._selector = selectors.DefaultSelector()
        self._server = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        with contextlib.suppress(FileNotFoundError):
            os.unlink(path)
        self._server.bind(path)
        self._server.listen(len(robots) + 4)
        self._server.setblocking(False)
        self._selector.register(self._server, selectors.EVENT_READ)

    def wait(self, seconds: float) -> None:
        """Handle what arrives within ``seconds``."""
        for key, _ in self._selector.select(seconds):
            if key.fileobj is self._server:
                self._accept()
            else:
                self._read(key.fileobj)  # type: ignore[arg-type]

    def request(self, robot: str, **message: Any) -> bool:
        """Ask a robot's monitor for something; False if it is not connected."""
        link = self._links.get(robot)
        if link is None:
            return False
        try:
            link.sendall(json.dumps(message).encode() + b"\n")
        except OSError:
            self._drop(link)
            return False
        return True

    def begin_anew(self, robot: str) -> None:
        """What the robot said before it was started again no longer counts."""
        side = self._side(robot)
        self.logs[robot].begin_anew(side[robot].time)
        side[robot] = RobotReport(robot)

    def _side(self, name: str) -> dict[str, RobotReport]:
        return self._bases if name in self._bases else self.reports

    def close(self) -> None:
        for link in list(self._buffers):
            self._drop(link)
        self._selector.close()
        self._server.close()

    def _accept(self) -> None:
        link, _ = self._server.accept()
        self._buffers[link] = b""
        self._selector.register(link, selectors.EVENT_READ)

    def _read(self, link: socket.socket) -> None:
        try:
            data = link.recv(65536)
        except OSError:
            data = b""
        if not data or len(self._buffers[link]) > MAXIMUM_LINE:
            self._drop(link)
            return
        *lines, self._buffers[link] = (self._buffers[link] + data).split(b"\n")
        for line in lines:
            self._take(link, line)

    def _take(self, link: socket.socket, line: bytes) -> None:
        try:
            values = json.loads(line)
            if values["robot"] in self._bases:
                values = self._on_the_robots_clock(values)
            report = self._side(values["robot"])[values["robot"]]
            self._links[report.robot] = link
            report.update(values)
            self.logs[report.robot].take(report.sample(), values.get("events", ()))
        except (ValueError, KeyError, TypeError):
            return

    def _on_the_robots_clock(self, values: dict[str, Any]) -> dict[str, Any]:
        """What a base station has told: it has no simulation time, and tells what is new about once a second."""
        now = statistics.median_low([report.time for report in self.reports.values()])
        return {**values, "time": now, "events": [{**event, "at": now} for event in values.get("events", ())]}

    def _drop(self, link: socket.socket) -> None:
        self._selector.unregister(link)
        self._buffers.pop(link, None)
        self._links = {name: other for name, other in self._links.items() if other is not link}
        link.close()
