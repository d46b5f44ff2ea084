"""A sweep on the workers of a Dask scheduler."""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import math
import pickle
import queue
import time
import urllib.parse
from pathlib import Path
from typing import Any, Callable, Iterator, Sequence, Tuple

from mr_experiments.sweep.sweep import TELL_PERIOD, Done, Tell
from mr_experiments.sweep.trial_process import (
    PATIENCE,
    crash_text,
    failed_record,
    how_it_ended,
    read_clock,
    record_path,
)
from mr_experiments.trial.trial import Trial, TrialError
from mr_measures.record.files import record_of_document, write_record
from mr_measures.record.mission_record import MissionRecord

ANSWER_PATIENCE = 10.0  # s of real time for an answer of a Dask scheduler
RECORD_PATIENCE = 600.0  # s of real time for a record to come from a worker


class ClusterLostError(RuntimeError):
    """The cluster is gone or unfit. What it has finished is recorded; the same sweep can go on later."""


UNFIT = 97  # exit code of a child that cannot even begin
_CHILD = f"""
import os, pathlib, pickle, sys
try:
    from mr_experiments.sweep import trial_process
    trial, snapshot_period, patience = pickle.load(sys.stdin.buffer)
except Exception as error:
    print(f"{{type(error).__name__}}: {{error}}", file=sys.stderr)
    sys.exit({UNFIT})
folder, parent = pathlib.Path(sys.argv[1]), int(sys.argv[2])
trial_process.run_as_child(trial, folder, snapshot_period, patience, parent, sys.stderr.buffer, folder / "clock")
"""

Answer = Tuple[str, int, bytes, bytes, bytes]
"""Of a worker: its computer, exit code, the record if there is one, what was written to stderr, the virtual time (as
ClockFile)."""


def remote_call() -> Callable[[bytes], Answer]:
    """What a worker does with a trial: a Python of its own, which the worker's other threads do not disturb and which
    cannot harm the worker. A nested function travels as code and not as a name, so that a worker without this software
    can still say what it lacks."""
    program = _CHILD

    def run_apart(request: bytes) -> Answer:
        import os
        import pathlib
        import platform
        import subprocess
        import sys
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            child = subprocess.run(
                [sys.executable, "-c", program, folder, str(os.getpid())],
                input=request, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False,
            )  # fmt: skip
            records = [path.read_bytes() for path in pathlib.Path(folder).glob("*.json")]
            clock = pathlib.Path(folder, "clock")
            time = clock.read_bytes() if clock.exists() else b""
            return platform.node(), child.returncode, b"".join(records), child.stderr, time

    return run_apart


class DaskCluster:
    """The same trials on the workers of a Dask scheduler. Records come back as values and are written here, so that
    the workers need this software and the worlds, but no folder in common."""

    def __init__(self, scheduler: str, snapshot_period: float = math.inf, patience: float = PATIENCE) -> None:
        """`patience`: as of LocalPool. Raises TrialError if Dask is not installed or the scheduler does not answer."""
        try:
            import distributed
        except ImportError:
            raise TrialError(
                "--scheduler needs Dask's distributed: apt-get install python3-distributed, here and on the workers"
            ) from None
        _check_address(scheduler)
        _silence("distributed")  # what matters of it is told here
        self._distributed, self._scheduler = distributed, scheduler
        self._snapshot_period, self._patience = snapshot_period, patience
        try:
            self._client = distributed.Client(scheduler, timeout=ANSWER_PATIENCE, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise TrialError(f"--scheduler {scheduler}: {' '.join(str(error).split())}") from None

    def close(self) -> None:
        """Lets go of the cluster; it stays as it is. What runs there comes to its end and is thrown away."""
        with contextlib.suppress(TimeoutError, asyncio.TimeoutError):  # of one that is lost there is no answer
            self._client.close(timeout=2.0)

    def run(self, trials: Sequence[Trial], folder: Path, tell: Tell = lambda _, __: None) -> Iterator[Done]:
        """Yields each trial when its record is written. A worker that dies loses nothing: others take over. Raises
        ClusterLostError if the scheduler is lost or no worker can run trials."""
        ended: queue.SimpleQueue[Any] = queue.SimpleQueue()
        requests = [pickle.dumps((trial, self._snapshot_period, self._patience)) for trial in trials]
        futures = self._client.map(remote_call(), requests, pure=False)
        waiting = {future.key: (future, trial) for future, trial in zip(futures, trials)}
        for future in futures:
            future.add_done_callback(ended.put)
        del futures, future  # the scheduler forgets what nobody here refers to
        told = -math.inf
        while waiting:
            if time.monotonic() - told > TELL_PERIOD:
                tell(*self._state(len(waiting)))
                told = time.monotonic()
            try:
                key = ended.get(timeout=TELL_PERIOD).key
            except queue.Empty:
                continue
            future, trial = waiting.pop(key)
            record = self._record_of(future, trial)
            write_record(record, record_path(folder, trial))
            yield Done.of(trial, record)

    @property
    def threads(self) -> int:
        """How many trials the workers can run at a time. Raises ClusterLostError."""
        try:
            threads = self._client.sync(self._client.scheduler.ncores, callback_timeout=ANSWER_PATIENCE)
        except Exception as error:
            raise self._lost(error) from None
        return sum(threads.values())

    def _state(self, waiting: int) -> tuple[int, str]:
        """Of the cluster: how many trials run, and what holds them up."""
        threads = self.threads
        return min(waiting, threads), "" if threads else f"{self._scheduler} has no workers: waiting for one"

    def _record_of(self, future: Any, trial: Trial) -> MissionRecord:
        try:
            if future.status in ("cancelled", "lost"):
                raise ConnectionError("the connection broke")
            error = future.exception(timeout=ANSWER_PATIENCE)
            if error is None:
                return self._record_from(future.result(timeout=RECORD_PATIENCE), trial)
        except ClusterLostError:
            raise
        except Exception as fault:
            raise self._lost(fault) from None
        if isinstance(error, self._distributed.KilledWorker):
            return failed_record(trial, f"several workers died of it: {error}")
        raise self._unfit(f"{type(error).__name__}: {error}")

    def _record_from(self, answer: Answer, trial: Trial) -> MissionRecord:
        host, code, written, told, clock = answer
        if code == UNFIT:
            raise self._unfit(f"{host}: {told.decode(errors='replace').strip()}")
        if not written:
            text = crash_text(told)
            return failed_record(trial, how_it_ended(code, text, self._patience), text, read_clock(clock))
        return record_of_document(json.loads(written))

    def _unfit(self, why: str) -> ClusterLostError:
        return ClusterLostError(f"a worker of {self._scheduler} cannot run trials ({why})")

    def _lost(self, error: Exception) -> ClusterLostError:
        told = " ".join(str(error).split()) or type(error).__name__
        return ClusterLostError(f"the scheduler {self._scheduler} is lost ({told})")


def _silence(package: str) -> None:
    for name in list(logging.root.manager.loggerDict):
        if name.split(".")[0] == package:
            logging.getLogger(name).setLevel(logging.CRITICAL)


def _check_address(scheduler: str) -> None:
    """A client with one that cannot be takes its time to say so."""
    try:
        parts = urllib.parse.urlsplit(scheduler)
        right = parts.scheme in ("tcp", "tls", "ws", "wss") and bool(parts.hostname) and parts.port is not None
    except ValueError:
        right = False
    if not right:
        raise TrialError(f"--scheduler {scheduler}: expected tcp://HOST:PORT")
