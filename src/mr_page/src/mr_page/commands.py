"""What a page can ask of a robot, by name."""

from __future__ import annotations

from typing import Awaitable, Callable, NamedTuple

SERVICES = {  # command: service of the robot (std_srvs/Trigger)
    "start": "explorer/start",
    "pause": "explorer/pause",
    "resume": "explorer/resume",
    "stop": "explorer/stop",
    "go_home": "explorer/go_home",
}
RADIO = {"radio_off": "down", "radio_on": "up"}  # command: word for the radio daemon of a simulated team
COMMANDS = (*SERVICES, *RADIO)


class Answer(NamedTuple):
    done: bool
    text: str


Command = Callable[[str, str], Awaitable[Answer]]
"""Asks a robot (by name) for something of COMMANDS."""
