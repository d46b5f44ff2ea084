"""Tells the radio daemon where the robots are, so that range follows the simulated world."""

import contextlib
import socket
from collections.abc import Callable, Sequence

import numpy as np

INTERVAL = 0.1  # s of simulated time between reports
RETRY = 1.0  # s between attempts to reach the daemon


class RadioControl:
    """Client of the radio daemon's control socket (SEQPACKET, text lines `position NAME X Y`, metres)."""

    def __init__(self, path: str, say: Callable[[str], None] = print) -> None:
        self._path = path
        self._say = say
        self._socket: socket.socket | None = None
        self._due = 0.0
        self._retry_at = 0.0
        self._said_lost = False

    def update(self, time: float, wall: float, names: Sequence[str], states: np.ndarray) -> None:
        """Report positions if due. `time`: simulated seconds, `wall`: monotonic seconds; `states`: World.states()."""
        if time < self._due or not self._connected(wall):
            return
        self._due = time + INTERVAL - 1e-9
        lines = "".join(f"position {n} {s['x']:.3f} {s['y']:.3f}\n" for n, s in zip(names, states, strict=True))
        assert self._socket is not None
        try:
            self._socket.send(lines.encode())
        except BlockingIOError:
            pass  # the daemon is busy: newer positions will replace these
        except OSError:
            self._lose(wall)

    def _connected(self, wall: float) -> bool:
        if self._socket is not None:
            return True
        if wall < self._retry_at:
            return False
        candidate = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET | socket.SOCK_NONBLOCK)
        try:
            candidate.connect(self._path)
        except OSError:
            candidate.close()
            self._lose(wall)
            return False
        self._socket = candidate
        self._said_lost = False
        return True

    def _lose(self, wall: float) -> None:
        self.close()
        self._retry_at = wall + RETRY
        if not self._said_lost:
            self._say(f"no radio daemon on {self._path}: trying again every {RETRY:g} s")
            self._said_lost = True

    def close(self) -> None:
        if self._socket is not None:
            with contextlib.suppress(OSError):
                self._socket.close()
        self._socket = None
