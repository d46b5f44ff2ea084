"""The process that people start: checks, starts the team in namespaces of its own, hands signals on, waits.

A pipe, the lifeline, ties both together. Lines on it are requests; its end means that this process is gone, and the
team ends at once.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
from dataclasses import replace
from types import FrameType
from typing import Callable, Sequence

from mr_launch import isolation
from mr_launch.hub_cleanup import end_descendants
from mr_launch.plan import Plan

PR_SET_CHILD_SUBREAPER = 36


def become_subreaper() -> None:
    """Orphans of this process's children come to this process, so that it can end them."""
    ctypes.CDLL(None, use_errno=True).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def run_team(plan: Plan, listener: socket.socket | None = None) -> int:
    """Run the checked plan to its end and return the exit code. ``listener``: for viewers of the status page, in the
    network of the machine, which the team leaves."""
    page = [listener.detach()] if listener else []

    def order(private: str) -> str:
        return replace(plan, private=private).to_json()

    return run_inside("mr_launch.inside", plan.isolation, order, page)


def run_inside(module: str, kind: str, order: Callable[[str], str], descriptors: Sequence[int] = ()) -> int:
    """Run ``python3 -m module LIFELINE ORDER [DESCRIPTOR...]`` as the first process of new namespaces, to its end.

    Args:
        kind: of isolation.
        order: what the process is told; takes the path of its private folder.
        descriptors: open ones that it inherits; they are closed here.
    """
    hub = kind == isolation.HUB
    private = tempfile.mkdtemp(prefix="mr_launch-") if hub else isolation.PRIVATE_MOUNT
    reader, writer = os.pipe()
    environment = {**os.environ, "PATH": isolation.search_path(os.environ.get("PATH", ""))}
    if hub:
        become_subreaper()
    command = [sys.executable, "-m", module, str(reader), order(private), *map(str, descriptors)]
    try:
        process = subprocess.Popen(
            [*isolation.enter_command(kind), *command],
            stdin=subprocess.DEVNULL,
            pass_fds=(reader, *descriptors),
            start_new_session=True,
            env=environment,
        )
        for descriptor in (reader, *descriptors):
            os.close(descriptor)
        hand_on_signals(writer)
        send(writer, f"init {first_process(process, hub)}")
        code = process.wait()
        return code if code >= 0 else 128 - code
    finally:
        os.close(writer)
        if hub:
            end_descendants()
            shutil.rmtree(private, ignore_errors=True)


def first_process(process: subprocess.Popen[bytes], hub: bool) -> int:
    """PID, as seen here, of the team's first process; that of ``unshare`` if the team is gone already."""
    while not hub and process.poll() is None:
        child = isolation.child_of(process.pid)
        if child is not None:
            return child
    return process.pid


def hand_on_signals(writer: int) -> None:
    def ask_to_stop(_signal: int, _frame: FrameType | None) -> None:
        send(writer, "stop")

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, ask_to_stop)


def send(writer: int, line: str) -> None:
    with contextlib.suppress(BrokenPipeError):  # the team is ending already
        os.write(writer, line.encode() + b"\n")
