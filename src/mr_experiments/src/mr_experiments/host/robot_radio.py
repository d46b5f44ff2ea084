"""One robot's end of the radio."""

from __future__ import annotations

from io import BytesIO

import genpy

from mr_experiments.common.stopwatch import Stopwatch
from mr_experiments.host.radio import Done, TeamRadio, TypedMessage


class RobotRadio:
    """The calls of adhoc_communication that the other nodes of a robot make."""

    def __init__(self, radio: TeamRadio, stopwatch: Stopwatch) -> None:
        self._radio, self._stopwatch = radio, stopwatch
        self.index = -1  # set when the robot is on the radio

    def send(self, service: str, destination: str, topic: str, message: bytes, done: Done) -> None:
        with self._stopwatch.span("radio"):
            self._radio.send(self.index, service, destination, topic, message, done)

    def send_typed(self, destination: str, topic: str, message: genpy.Message, done: Done) -> None:
        """The service send_message: `message` may be of any type. The others hear its serialisation on `topic`."""
        with self._stopwatch.span("messages"):
            octets = BytesIO()
            message.serialize(octets)
            typed = TypedMessage(message._type, message._md5sum, message._full_text, octets.getvalue())
        with self._stopwatch.span("radio"):
            self._radio.send_message(self.index, destination, topic, typed, done)

    def neighbors(self) -> list[str]:
        return self._radio.neighbors(self.index)

    def robots(self) -> list[str]:
        return self._radio.robots(self.index)
