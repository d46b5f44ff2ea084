"""The robots' radio in virtual time: their protocol engines on a simulated medium."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any, Callable, NamedTuple, Protocol, Sequence

import adhoc_engine
import numpy as np

from mr_experiments.trial.radio_options import RadioOptions

NANOSECONDS = 1_000_000_000
EVERYWHERE = 1e6  # m, the reach of a radio without limits

Done = Callable[[bool, str], None]
"""Called at the end of a send: whether it was delivered, and why not."""


class TypedMessage(NamedTuple):
    """A message of any type, as the service send_message takes it."""

    type: str  # package/Name
    md5sum: str
    definition: str  # full text, as in bag files
    data: bytes  # ROS serialisation


@dataclass(frozen=True)
class Walls:
    """Occupied cells, uint8 (rows, columns), m per cell, lower left corner in m."""

    cells: np.ndarray
    resolution: float
    origin: tuple[float, float]


class Listener(Protocol):
    """What a robot wants to hear from its radio."""

    def on_packet(self, topic: str, message: bytes, now: float) -> None:
        """A ROS message, serialised, for this topic."""

    def on_robot_appeared(self, robot: str, now: float) -> None: ...

    def on_robot_lost(self, robot: str, now: float) -> None: ...


class TeamRadio(Protocol):
    """All robots' radios. Robots are numbered in the order in which they are added; times in s, places in m."""

    def add(self, name: str, listener: Listener, place: Sequence[float]) -> int: ...

    def switch_off(self, robot: int) -> None: ...

    def switch_on(self, robot: int) -> None: ...

    def place(self, robot: int, x: float, y: float) -> None: ...

    def send(self, robot: int, service: str, destination: str, topic: str, message: bytes, done: Done) -> None: ...

    def send_message(self, robot: int, destination: str, topic: str, message: TypedMessage, done: Done) -> None: ...

    def neighbors(self, robot: int) -> list[str]: ...

    def robots(self, robot: int) -> list[str]: ...

    def statistics(self, robot: int) -> dict[str, Any]: ...

    def advance(self, until: float) -> float: ...

    def tell(self, now: float) -> None: ...

    @property
    def trace(self) -> str: ...


class Radio:
    """All robots' engines on the simulated medium."""

    def __init__(self, options: RadioOptions, seed: int, walls: Walls | None = None) -> None:
        medium = adhoc_engine.MediumOptions()
        medium.range = min(options.range, EVERYWHERE)
        medium.loss = options.loss
        medium.bit_rate = options.bit_rate
        medium.contention = options.contention
        if options.wall_attenuation > 0.0 and walls is not None:
            medium.set_walls(walls.cells, walls.resolution, walls.origin)
            medium.wall_attenuation = options.wall_attenuation
        self._team = adhoc_engine.Team(medium, seed)
        if options.sealed:
            self._team.set_key(hashlib.sha256(f"team {seed}".encode()).digest())
        self._listeners: list[Listener] = []
        self._down: set[int] = set()
        self._waiting: dict[tuple[int, int], Done] = {}
        self._heard: list[tuple[int, Any]] = []
        self._last_statistics: dict[int, dict[str, Any]] = {}  # of robots whose radio is off

    def add(self, name: str, listener: Listener, place: Sequence[float]) -> int:
        """A robot at `place` (x, y in m, world frame)."""
        options = adhoc_engine.EngineOptions()
        options.robot_name = name
        self._listeners.append(listener)
        return int(self._team.add(options, place[0], place[1]))

    def switch_off(self, robot: int) -> None:
        """The robot's radio falls silent and forgets everything. Its sends fail."""
        self._last_statistics[robot] = self.statistics(robot)
        self._down.add(robot)
        self._team.kill(robot)
        for key in [key for key in self._waiting if key[0] == robot]:
            self._waiting.pop(key)(False, "the radio was switched off")

    def switch_on(self, robot: int) -> None:
        """After `switch_off`: with a new boot id."""
        self._down.discard(robot)
        self._team.restart(robot)

    def place(self, robot: int, x: float, y: float) -> None:
        """Where the robot is now, m, world frame."""
        self._team.set_position(robot, x, y)

    def send(self, robot: int, service: str, destination: str, topic: str, message: bytes, done: Done) -> None:
        """What a call of adhoc_communication's service does; `done` is its answer."""
        self._begin(robot, done, lambda: self._team.send(robot, service, destination, topic, message))

    def send_message(self, robot: int, destination: str, topic: str, message: TypedMessage, done: Done) -> None:
        """What a call of its service send_message does. The receiver hears `message.data` on the topic."""
        self._begin(robot, done, lambda: self._team.send_message(robot, destination, topic, *message))

    def _begin(self, robot: int, done: Done, send: Callable[[], int]) -> None:
        if robot in self._down:
            done(False, "the radio is switched off")
            return
        self._waiting[robot, send()] = done

    def neighbors(self, robot: int) -> list[str]:
        return [] if robot in self._down else list(self._team.neighbors(robot))

    def robots(self, robot: int) -> list[str]:
        """All that are known, over however many hops."""
        return [] if robot in self._down else list(self._team.robots(robot))

    def statistics(self, robot: int) -> dict[str, Any]:
        """Of a robot whose radio is off: the last ones."""
        return self._last_statistics.get(robot, {}) if robot in self._down else dict(self._team.statistics(robot))

    @property
    def trace(self) -> str:
        """Changes with every frame on the air and its time."""
        return f"{self._team.trace_hash:016x}"

    def advance(self, until: float) -> float:
        """Runs to `until`, or to the first moment at which a robot hears something; returns the time reached."""
        goal = round(until * NANOSECONDS)
        self._heard = self._team.advance(goal)
        return until if self._team.now >= goal else float(self._team.now / NANOSECONDS)

    def tell(self, now: float) -> None:
        """Tells the listeners what was heard at the time reached. Apart from `advance`, so that their clock shows that
        time by then."""
        heard, self._heard = self._heard, []
        for robot, event in heard:
            self._report(robot, event, now)

    def _report(self, robot: int, event: Any, now: float) -> None:
        if isinstance(event, adhoc_engine.SendFinished):
            done = self._waiting.pop((robot, event.id), None)
            if done is not None:
                done(event.delivered, event.reason)
            return
        if robot in self._down:
            return
        listener = self._listeners[robot]
        if isinstance(event, adhoc_engine.PacketReceived):
            listener.on_packet(event.topic, event.message()[1], now)
        elif isinstance(event, adhoc_engine.RobotAppeared):
            listener.on_robot_appeared(event.robot, now)
        elif isinstance(event, adhoc_engine.RobotLost):
            listener.on_robot_lost(event.robot, now)
