"""A computation in a process of its own with bounded time and memory: what does not end takes nothing else with it."""

from __future__ import annotations

import math
import multiprocessing
import os
import resource
import signal
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar

BUSY = 4.0  # times the processor time: what a computation may take on a computer that others use, too

Result = TypeVar("Result")


@dataclass(frozen=True)
class Bounds:
    """`seconds` of processor time, rounded up to whole ones; `octets` of memory beyond what this process has."""

    seconds: float
    octets: int


class NoResult(Exception):
    """A computation exceeded its bounds, or its process ended; the text says which."""


class _Origin(Exception):
    """Where in the other process an exception was raised."""


def bounded(task: Callable[[], Result], bounds: Bounds) -> Result:
    """What the task returns, or raises, in a process forked from this one. Raises NoResult."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_compute, args=(task, bounds, sender), daemon=True)
    process.start()
    sender.close()
    try:
        answer = _answer(receiver, process, bounds)
    finally:
        process.kill()
        process.join()
        receiver.close()
    if answer.error is not None:
        raise answer.error from (_Origin(answer.trace) if answer.trace else None)
    result: Result = answer.result
    return result


@dataclass(frozen=True)
class _Answer:
    result: Any = None
    error: Exception | None = None
    trace: str = ""


def _answer(receiver: Connection, process: BaseProcess, bounds: Bounds) -> _Answer:
    patience = BUSY * math.ceil(bounds.seconds)
    if not receiver.poll(patience):
        return _Answer(error=NoResult(f"did not end in {patience:g} s"))
    try:
        answer: _Answer = receiver.recv()
    except (EOFError, OSError):  # before its answer, or in the midst of it
        process.join()
        return _Answer(error=NoResult(_how_it_ended(process.exitcode or 0, bounds)))
    return answer


def _how_it_ended(code: int, bounds: Bounds) -> str:
    if code == -signal.SIGXCPU:
        return f"took more than {math.ceil(bounds.seconds)} s of processor time"
    if code < 0:
        return f"its process was ended by {signal.Signals(-code).name}"
    return f"its process ended with exit code {code}"


def _compute(task: Callable[[], Any], bounds: Bounds, sender: Connection) -> None:
    """Ctrl-C is the parent's affair."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    seconds = math.ceil(bounds.seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
    most = _address_space() + bounds.octets
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        answer = _Answer(task())
    except MemoryError:
        answer = _Answer(error=NoResult(f"took more than {bounds.octets / 1e9:.1f} GB of memory"))
    except Exception as error:
        answer = _Answer(error=error, trace=traceback.format_exc())
    sender.send(answer)


def _address_space() -> int:
    """Octets of this process."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
