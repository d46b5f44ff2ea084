"""The inner end of the pipe to the process that people started."""

from __future__ import annotations

import os
import threading
from typing import Callable


class Lifeline:
    """Reads requests in a thread of its own, so that the end of the pipe works whatever the main thread does.

    Args:
        descriptor: read end of the pipe.
        gone: called when the other process is gone; must not return.
    """

    def __init__(self, descriptor: int, gone: Callable[[], None]) -> None:
        self.stop = threading.Event()
        self.init: int | None = None
        self._init_known = threading.Event()
        self._gone = gone
        threading.Thread(target=self._read, args=(descriptor,), daemon=True).start()

    def wait_for_init(self, seconds: float) -> int | None:
        """PID of this process as the outer process sees it."""
        self._init_known.wait(seconds)
        return self.init

    def _read(self, descriptor: int) -> None:
        with os.fdopen(descriptor, "r") as lines:
            for line in lines:
                self._handle(line.split())
        self._gone()

    def _handle(self, words: list[str]) -> None:
        if words[:1] == ["init"]:
            self.init = int(words[1])
            self._init_known.set()
        elif words[:1] == ["stop"]:
            if self.stop.is_set():
                self._gone()  # asked twice: do not wait for anybody
            self.stop.set()
