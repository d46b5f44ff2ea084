"""Runs the recorder of a robot and ends it in order before the disk is full: then its bag is whole, there is room left
for logs, and the mission goes on unrecorded. The recorder closes its bag, too, when this process dies."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import FrameType
from typing import Sequence

PERIOD = 1.0  # s between two looks at the disk
PATIENCE = 20.0  # s for the recorder to close its bag
LABEL = "record: "  # begins what is said of the recording


def guarded(command: Sequence[str], folder: Path, least: int, stays: bool = False) -> int:
    """Runs `command` until it ends or less than `least` octets are free in `folder`; returns the exit code, 0 if it was
    for the disk. SIGINT reaches the whole process group, as roslaunch sends it. `stays`: whoever ends is started again,
    so after an end that is to last (exit code 0) this waits for SIGINT or SIGTERM."""
    process = subprocess.Popen(["setpriv", "--pdeathsig", "INT", "--", *command])
    asked: list[int] = []

    def ask(number: int, _: FrameType | None) -> None:
        asked.append(number)
        if number == signal.SIGTERM:
            process.terminate()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, ask)
    code = _followed(process, folder, least)
    while stays and code == 0 and not asked:
        time.sleep(PERIOD)
    return code


def _followed(process: subprocess.Popen[bytes], folder: Path, least: int) -> int:
    """Exit code as of `guarded`."""
    while _runs(process, PERIOD):
        if free(folder) < least:
            process.send_signal(signal.SIGINT)
            if _runs(process, PATIENCE):
                process.kill()
                process.wait()
            return _said(folder, least)
    if process.returncode and free(folder) < least:
        return _said(folder, least)
    return process.returncode


def free(folder: Path) -> int:
    """Octets that users may still write in `folder`; none where it is gone."""
    try:
        status = os.statvfs(folder)
    except OSError:
        return 0
    return status.f_bavail * status.f_frsize


def _runs(process: subprocess.Popen[bytes], seconds: float) -> bool:
    """Whether it still runs after so long."""
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        return True
    return False


def _said(folder: Path, least: int) -> int:
    what = f"less than {least / 1e6:.0f} MB are free in {folder}" if folder.is_dir() else f"there is no folder {folder}"
    text = f"{what}; the recording has ended, the mission goes on without"
    print(f"{LABEL}{text}", file=sys.stderr, flush=True)
    return 0
