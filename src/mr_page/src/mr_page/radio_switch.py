"""Switches the radios of simulated robots off and on, over the control socket of the radio daemon."""

from __future__ import annotations

import socket

from mr_page.commands import RADIO, Answer


class RadioSwitch:
    """`path`: control socket of `rosrun adhoc_communication radio`."""

    def __init__(self, path: str) -> None:
        self._path = path

    def switch(self, robot: str, command: str) -> Answer:
        if not robot or any(character.isspace() for character in robot):
            return Answer(False, f"{robot!r} is no name of a robot")
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as control:
                control.settimeout(2.0)
                control.connect(self._path)
                control.send(f"{RADIO[command]} {robot}\n".encode())
        except OSError as error:
            return Answer(False, f"the radio daemon does not answer at {self._path}: {error.strerror or error}")
        return Answer(True, f"radio of {robot} {'off' if command == 'radio_off' else 'on'}")
