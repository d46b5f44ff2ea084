"""A radio without frames: every message arrives at all who should have it, a moment after it was sent."""

from __future__ import annotations

import zlib
from functools import partial
from typing import Any, Sequence

from mr_experiments.host.agenda import Agenda
from mr_experiments.host.radio import Done, Listener, TypedMessage

DELAY = 0.01  # s


class PerfectRadio:
    """Takes the place of `radio.Radio` where only the strategy is asked for."""

    def __init__(self, agenda: Agenda) -> None:
        self._agenda = agenda
        self._names: list[str] = []
        self._listeners: list[Listener] = []
        self._on_air: set[int] = set()
        self._sent: list[int] = []
        self._octets: list[int] = []
        self._checksum = 0
        self._now = 0.0

    def add(self, name: str, listener: Listener, place: Sequence[float]) -> int:
        self._names.append(name)
        self._listeners.append(listener)
        self._sent.append(0)
        self._octets.append(0)
        self.switch_on(len(self._names) - 1)
        return len(self._names) - 1

    def switch_off(self, robot: int) -> None:
        self._on_air.discard(robot)
        for other in sorted(self._on_air):
            listener = self._listeners[other]
            self._agenda.at(self._now + DELAY, partial(listener.on_robot_lost, self._names[robot]))

    def switch_on(self, robot: int) -> None:
        for other in sorted(self._on_air):
            self._agenda.at(self._now + DELAY, partial(self._listeners[other].on_robot_appeared, self._names[robot]))
            self._agenda.at(self._now + DELAY, partial(self._listeners[robot].on_robot_appeared, self._names[other]))
        self._on_air.add(robot)

    def place(self, robot: int, x: float, y: float) -> None:
        """Everybody is in reach."""

    def send(self, robot: int, service: str, destination: str, topic: str, message: bytes, done: Done) -> None:
        if robot not in self._on_air:
            done(False, "the radio is switched off")
            return
        self._sent[robot] += 1
        self._octets[robot] += len(message)
        self._checksum = zlib.crc32(message, self._checksum)
        receivers = [i for i in sorted(self._on_air) if i != robot]
        if not destination.startswith("mc_"):
            receivers = [i for i in receivers if self._names[i] == destination]
        self._agenda.at(self._now + DELAY, partial(self._arrive, receivers, topic, message, done))

    def send_message(self, robot: int, destination: str, topic: str, message: TypedMessage, done: Done) -> None:
        self.send(robot, "send_message", destination, topic, message.data, done)

    def _arrive(self, receivers: list[int], topic: str, message: bytes, done: Done, now: float) -> None:
        self._now = now
        for receiver in receivers:
            self._listeners[receiver].on_packet(topic, message, now)
        done(bool(receivers), "" if receivers else "no such robot")

    def neighbors(self, robot: int) -> list[str]:
        return [self._names[i] for i in sorted(self._on_air) if i != robot] if robot in self._on_air else []

    def robots(self, robot: int) -> list[str]:
        return self.neighbors(robot)

    def statistics(self, robot: int) -> dict[str, Any]:
        """Messages count as frames."""
        return {
            "frames_sent": self._sent[robot], "bytes_sent": self._octets[robot], "packets_sent": self._sent[robot],
            "packets_failed": 0,
        }  # fmt: skip

    @property
    def trace(self) -> str:
        """Changes with every message."""
        return f"{self._checksum:08x}"

    def advance(self, until: float) -> float:
        self._now = until
        return until

    def tell(self, now: float) -> None:
        """Messages come by the agenda."""
