"""The runner's eye on one robot: gathers what the nodes publish and reports it as JSON lines. Knows no ROS."""

from __future__ import annotations

import json
import math
import select
import socket
from collections import deque
from typing import Any, Mapping, Sequence

from mr_grid import Pose
from mr_measures.drift import SPACING
from mr_measures.record.beliefs import Beliefs

LONGEST_TEXT = 500  # characters of what a node says
MOST_EVENTS = 1000  # that wait for the next report; beyond, the oldest are lost
PARTS = ("adhoc_communication", "map", "map_merger", "explorer", "move_base")


class Digest:
    """Collects the news of one robot; ``report`` gives what changed into the runner's RobotReport and RobotLog. Times
    in s of simulation time."""

    def __init__(self, robot: str) -> None:
        self.robot = robot
        self._values: dict[str, Any] = {}
        self._missing = set(PARTS)
        self._beliefs = Beliefs()
        self._events: deque[dict[str, Any]] = deque(maxlen=MOST_EVENTS)
        self._goals = 0
        self._goal = ""  # move_base's name of the present one
        self._bids = 0
        self._opened: int | None = None  # number of the auction that was opened last
        self._auction: int | None = None  # of which it was told last what came of it
        self._place: Pose | None = None  # told last

    def seen(self, part: str) -> None:
        """This part of the robot is up."""
        self._missing.discard(part)

    @property
    def missing(self) -> list[str]:
        return [part for part in PARTS if part in self._missing]

    def set(self, **values: Any) -> None:
        self._values.update(values)

    def believes(self, transforms: Mapping[str, Pose], now: float) -> None:
        """All transforms to other robots' maps that are believed."""
        self._values.update(sees_merges=True, merged=sorted(transforms))
        for name, transform in self._beliefs.changes(transforms):
            place = None if transform is None else [round(value, 5) for value in transform]
            self._happened("merge", now, partner=name, transform=place)

    def located(self, pose: Pose, at: float) -> None:
        """Where the robot believed to be at `at`, in its map. Told often enough for `mr_measures.drift.Track`."""
        if self._place is None or math.dist(pose[:2], self._place[:2]) >= 0.5 * SPACING:
            self._place = pose
            self._happened("pose", at, place=[round(value, 5) for value in pose])

    def goal(self, name: str, x: float, y: float, now: float) -> None:
        """Somebody sends the robot there; `name`: by which move_base tells its end. m, frame ``map``."""
        self._goals, self._goal = self._goals + 1, name
        self._happened("goal", now, id=self._goals, x=round(x, 4), y=round(y, 4))

    def goal_end(self, name: str, outcome: str, text: str, now: float) -> None:
        """That of a former goal is no news: the one after has replaced it."""
        if name == self._goal:
            self._happened("goal_end", now, outcome=outcome, text=text[:LONGEST_TEXT])

    def auction(self, number: int, clusters: int, now: float) -> None:
        """The robot opens one."""
        self._opened = number
        self._happened("auction", now, id=number, clusters=clusters)

    def answer(self, number: int, robot: str, now: float) -> None:
        """Another robot's bids have come; those for auctions of others come, too, and are no news."""
        if number == self._opened:
            self._happened("answer", now, number=number, robot=robot)

    def auction_result(self, number: int, unit: int, offers: Sequence[Mapping[str, Any]], now: float) -> None:
        """What came of an auction of the robot; news once. `offers`: as `mr_measures.record.robot_record.Offer`."""
        if offers and number != self._auction:
            self._auction = number
            self._happened("auction_result", now, number=number, unit=unit, offers=list(offers))

    def bid(self) -> None:
        """The robot answers another's auction."""
        self._bids += 1
        self._values["bids"] = self._bids

    def note(self, text: str, warning: bool, now: float) -> None:
        """What one of its nodes says."""
        self._happened("note", now, text=text[:LONGEST_TEXT], warning=warning)

    def _happened(self, kind: str, at: float, **values: Any) -> None:
        self._events.append({"kind": kind, "at": at, **values})

    def report(self, now: float) -> dict[str, Any]:
        """Each event is in one report only."""
        events = [self._events.popleft() for _ in range(len(self._events))]  # others may append meanwhile
        return {"robot": self.robot, "time": now, "missing": self.missing, "events": events, **self._values}


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
