"""Ends what a process started, grandchildren included, where no PID namespace does it."""

from __future__ import annotations

import contextlib
import os
import signal
import time

from mr_launch.processes import cpu_seconds


def descendants(root: int, parents: dict[int, int]) -> list[int]:
    """All processes below ``root``, given the parent of each process, parents before children."""
    found = [root]
    for pid in found:
        found += [child for child, parent in parents.items() if parent == pid and child not in found]
    return found[1:]


def end_descendants(patience: float = 5.0) -> None:
    """Kill every process below this one until none is left. This process must be their subreaper."""
    end = time.monotonic() + patience
    while time.monotonic() < end:
        parents = {pid: parent for pid, (_, _, parent) in cpu_seconds().items()}
        below = descendants(os.getpid(), parents)
        for pid in below:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        with contextlib.suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        if not below:
            return
        time.sleep(0.05)
