"""The base of a centralized team in virtual time: a radio and a map_merger, no body and no explorer."""

from __future__ import annotations

from typing import Callable, Protocol

from map_merger.messages import Boot
from map_merger.options import Options
from mr_experiments.common.stopwatch import Stopwatch
from mr_experiments.host.agenda import Agenda
from mr_experiments.host.merging import Merger
from mr_experiments.host.radio import TeamRadio
from mr_experiments.host.robot_radio import RobotRadio
from mr_grid import OccupancyGrid

NAME = "base"
STATUS_PERIOD = 1.0  # s between two messages of adhoc_communication/status


class NoteTaker(Protocol):
    """Who writes down what a participant says."""

    def note(self, name: str, text: str, warning: bool, now: float) -> None: ...


class BaseStation:
    """Stands at `place` (x, y in m, world frame) and merges for all robots."""

    def __init__(
        self, place: tuple[float, float], options: Options, boot: Boot, agenda: Agenda, radio: TeamRadio,
        stopwatch: Stopwatch, notes: NoteTaker, clock: Callable[[], float],
    ) -> None:  # fmt: skip
        self.own_radio = RobotRadio(radio, stopwatch)
        self.merger = Merger(options, boot, agenda, self.own_radio, stopwatch, self, clock)
        self.running = False
        self._agenda, self._notes, self._clock = agenda, notes, clock
        self.own_radio.index = radio.add(NAME, self, place)

    def start(self, now: float) -> None:
        """Its nodes are up."""
        self.running = True
        self.merger.start(now)
        self._agenda.every(STATUS_PERIOD, now, lambda _: self._on_status())

    def _on_status(self) -> None:
        for robot in self.own_radio.robots():
            self.merger.on_robot(robot)

    # What the radio brings.

    def on_packet(self, topic: str, message: bytes, now: float) -> None:
        if self.running:
            self.merger.on_packet(topic, message)

    def on_robot_appeared(self, robot: str, now: float) -> None:
        if self.running:
            self.merger.on_robot(robot, returned=True)

    def on_robot_lost(self, robot: str, now: float) -> None:
        if self.running:
            self.merger.on_robot_lost(robot)

    # What the merger publishes.

    def on_global_map(self, grid: OccupancyGrid, now: float) -> None:
        """Nobody here reads it."""

    def on_positions(self, positions: dict[str, tuple[float, float]], now: float) -> None:
        """Nor these."""

    def on_note(self, text: str, warning: bool, now: float) -> None:
        self._notes.note(NAME, text, warning, now)
