"""What a page can ask of a robot, by name."""

from __future__ import annotations

from typing import Awaitable, Callable, NamedTuple

ORDERS = ("start", "pause", "resume", "return_now", "stop", "go_home")
SERVICES = {  # command: service at the robot's own master (std_srvs/Trigger); which of them there are is looked up
    **{order: f"explorer/{order}" for order in ORDERS},  # for this robot
    **{f"team_{order}": f"mission_control/{order}" for order in ORDERS},  # for all that its radio reaches
}
RADIO = {"radio_off": "down", "radio_on": "up"}  # command: word for the radio daemon of a simulated team
COMMANDS = (*SERVICES, *RADIO)


class Answer(NamedTuple):
    done: bool
    text: str


Command = Callable[[str, str], Awaitable[Answer]]
"""Asks a robot (by name) for something of COMMANDS."""
