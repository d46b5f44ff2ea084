"""One robot's end of the radio."""

from __future__ import annotations

from mr_experiments.radio import Done, TeamRadio
from mr_experiments.stopwatch import Stopwatch


class RobotRadio:
    """The calls of adhoc_communication that the other nodes of a robot make."""

    def __init__(self, radio: TeamRadio, stopwatch: Stopwatch) -> None:
        self._radio, self._stopwatch = radio, stopwatch
        self.index = -1  # set when the robot is on the radio

    def send(self, service: str, destination: str, topic: str, message: bytes, done: Done) -> None:
        with self._stopwatch.span("radio"):
            self._radio.send(self.index, service, destination, topic, message, done)

    def neighbors(self) -> list[str]:
        return self._radio.neighbors(self.index)

    def robots(self) -> list[str]:
        return self._radio.robots(self.index)
