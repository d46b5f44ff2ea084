"""What the first process of a team, live or played back, does before anything else, and when nobody waits for it any
more."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from pathlib import Path
from typing import Callable, Sequence

from mr_launch import isolation
from mr_launch.errors import TeamFailure
from mr_launch.exit_codes import INTERRUPTED
from mr_launch.hub_cleanup import end_descendants
from mr_launch.lifeline import Lifeline
from mr_launch.outside import become_subreaper


def make_private_file_system(kind: str, private: str, hosts: Sequence[str]) -> None:
    """A file system at `private` that nobody else sees and that goes with the namespace, with a ROS_HOME for each host;
    without namespaces the folder serves."""
    if kind != isolation.HUB:
        command = ["mount", "-t", "tmpfs", "-o", "mode=0755", "none", private]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode != 0:
            raise TeamFailure(f"no private file system: {result.stderr.strip()}")
        subprocess.run(["ip", "link", "set", "lo", "up"], check=False)
    for host in hosts:
        (Path(private) / "ros_home" / host).mkdir(parents=True)


def hold_lifeline(descriptor: int, kind: str, private: str) -> Lifeline:
    """Signals ask to stop; when the process that people started is gone, everything ends at once."""
    if kind == isolation.HUB:
        become_subreaper()
    lifeline = Lifeline(descriptor, _end_at_once(kind, private))
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: lifeline.stop.set())
    return lifeline


def _end_at_once(kind: str, private: str) -> Callable[[], None]:
    def end() -> None:
        if kind == isolation.HUB:
            end_descendants()
            shutil.rmtree(private, ignore_errors=True)
        os._exit(INTERRUPTED)

    return end
