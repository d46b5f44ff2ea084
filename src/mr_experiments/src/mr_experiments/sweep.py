"""Many trials: which there are, which are done already, and who runs them."""

from __future__ import annotations

import faulthandler
import json
import logging
import math
import multiprocessing
import multiprocessing.connection
import os
import pickle
import queue
import signal
import tempfile
import threading
import time
import traceback
import urllib.parse
from dataclasses import dataclass
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import IO, Any, Callable, Iterable, Iterator, Optional, Protocol, Sequence, Tuple

import cv2

from mr_experiments.record import FORMAT, run_trial, versions, write_record
from mr_experiments.trial import Trial, TrialError

LONGEST = 3600.0  # s of real time for one trial
TELL_PERIOD = 0.5  # s of real time between two words on how it goes
ANSWER_PATIENCE = 10.0  # s of real time for an answer of a Dask scheduler

Tell = Callable[[int, str], None]
"""Called while trials run: how many do, and what holds them up ("" if nothing does)."""


class ClusterLostError(RuntimeError):
    """The cluster is gone or unfit. What it has finished is recorded; the same sweep can go on later."""


@dataclass(frozen=True)
class Done:
    """What a sweep tells of a trial whose record is written."""

    trial: Trial
    status: str
    reason: str
    exploration_time: float | None  # s
    map_errors: tuple[float, ...]  # percent, of the robots that have one
    real_time_factor: float | None

    @classmethod
    def of(cls, trial: Trial, record: dict[str, Any]) -> Done:
        """Raises KeyError, TypeError or AttributeError if it is no record."""
        errors = [robot["map"].get("error") for robot in record["robots"].values()]
        return cls(
            trial, record["outcome"]["status"], record["outcome"]["reason"], record["team"]["exploration_time"],
            tuple(error for error in errors if error is not None), record.get("measured", {}).get("real_time_factor"),
        )  # fmt: skip


def record_path(folder: Path, trial: Trial) -> Path:
    return folder / f"{trial.key}.json"


def split_done(trials: Iterable[Trial], folder: Path) -> tuple[list[Trial], list[Done]]:
    """What is left to do, and what an earlier run has recorded. Raises TrialError for a record of another trial."""
    left: list[Trial] = []
    done: list[Done] = []
    for trial in trials:
        path = record_path(folder, trial)
        if path.exists():
            done.append(_read_done(trial, path))
        else:
            left.append(trial)
    return left, done


def _read_done(trial: Trial, path: Path) -> Done:
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        recorded, number, entry = record["trial"], record["format"], Done.of(trial, record)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        told = f"{error} is missing" if isinstance(error, KeyError) else str(error)
        raise TrialError(f"{path} is no record ({told}); remove it to run the trial again") from None
    if number != FORMAT:
        raise TrialError(f"{path} is a record of format {number}, not {FORMAT}; choose another --out or remove it")
    asked = json.loads(json.dumps(trial.to_json()))
    if recorded != asked:
        raise TrialError(
            f"{path} is the record of another trial ({_difference(recorded, asked)}); choose another --out or remove it"
        )
    return entry


def _difference(recorded: Any, asked: dict[str, Any]) -> str:
    if not isinstance(recorded, dict):
        return "its configuration cannot be read"
    key = next(key for key in {**asked, **recorded} if asked.get(key) != recorded.get(key))
    return f"{key}: {recorded.get(key)!r}, not {asked.get(key)!r}"


def failed_record(trial: Trial, reason: str, trace: str = "") -> dict[str, Any]:
    """Of a trial that left none itself."""
    outcome = {"status": "failed", "reason": reason, "time": 0.0}
    if trace:
        outcome["traceback"] = trace
    return {
        "format": FORMAT,
        "trial": trial.to_json(),
        "versions": versions(),
        "outcome": outcome,
        "team": {"exploration_time": None, "series": {"time": [], "explored": [], "coverage": []}},
        "robots": {},
        "maps": {},
        "snapshots": [],
    }


class Runner(Protocol):
    """Who runs trials and writes their records."""

    def run(self, trials: Sequence[Trial], folder: Path, tell: Tell = ...) -> Iterator[Done]:
        """Yields each trial when its record is written."""


def _run_and_write(trial: Trial, folder: Path, snapshot_period: float) -> None:
    path = record_path(folder, trial)
    try:
        write_record(run_trial(trial, snapshot_period), path)
    except Exception as error:
        write_record(failed_record(trial, f"{type(error).__name__}: {error}", traceback.format_exc()), path)


def _run_as_child(trial: Trial, folder: Path, snapshot_period: float, parent: int, crash: IO[bytes]) -> None:
    """The whole life of a process that runs one trial. Ctrl-C is the parent's affair; without it there is no use.
    Where an engine crashes goes to `crash`."""
    faulthandler.enable(crash, all_threads=False)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_without, args=(parent,), daemon=True).start()
    _run_and_write(trial, folder, snapshot_period)


def _end_without(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)


def _how_it_ended(code: int | None) -> str:
    """In words, of a process that left no record. Negative: the signal that ended it."""
    if code is None or code >= 0:
        return f"its process ended with exit code {code}"
    name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
    hint = " (out of memory?)" if -code == signal.SIGKILL else ""
    return f"its process was ended by {name}{hint}"


def _crash_text(told: bytes) -> str:
    """Of what Python's faulthandler writes: where it happened, without the list of all modules."""
    return told.decode(errors="replace").split("\nExtension modules")[0][:4000]


def _took_too_long(longest: float) -> str:
    return f"took longer than {longest:g} s of real time and was ended"


@dataclass
class _Running:
    process: BaseProcess
    trial: Trial
    deadline: float  # s, monotonic
    crash: IO[bytes]
    late: bool = False

    def over(self) -> bool:
        if self.process.is_alive() and time.monotonic() > self.deadline:
            self.late = True
            self.process.kill()
            self.process.join()
        return not self.process.is_alive()


class LocalPool:
    """Each trial in a process of its own, so that none can harm another; `jobs` at a time."""

    def __init__(self, jobs: int, snapshot_period: float = math.inf, longest: float = LONGEST) -> None:
        """`longest`: s of real time after which a trial is ended."""
        self._jobs, self._snapshot_period, self._longest = jobs, snapshot_period, longest
        # What this process has loaded and computed is there in each of them at once.
        self._context = multiprocessing.get_context("fork")
        cv2.setNumThreads(1)  # threads do not survive a fork, and a pool of them would wait for each other

    def run(self, trials: Sequence[Trial], folder: Path, tell: Tell = lambda _, __: None) -> Iterator[Done]:
        """Yields each trial when its record is written."""
        waiting = list(trials)
        running: list[_Running] = []
        try:
            while waiting or running:
                while waiting and len(running) < self._jobs:
                    running.append(self._begin(waiting.pop(0), folder))
                tell(len(running), "")
                multiprocessing.connection.wait([entry.process.sentinel for entry in running], TELL_PERIOD)
                for entry in [entry for entry in running if entry.over()]:
                    running.remove(entry)
                    yield self._end(entry, folder)
        finally:
            for entry in running:
                entry.process.kill()
                entry.process.join()

    def _begin(self, trial: Trial, folder: Path) -> _Running:
        crash = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the process
        arguments = (trial, folder, self._snapshot_period, os.getpid(), crash)
        process = self._context.Process(target=_run_as_child, args=arguments, daemon=True)
        process.start()
        return _Running(process, trial, time.monotonic() + self._longest, crash)

    def _end(self, entry: _Running, folder: Path) -> Done:
        entry.process.join()
        path = record_path(folder, entry.trial)
        if not path.exists():
            reason = _took_too_long(self._longest) if entry.late else _how_it_ended(entry.process.exitcode)
            entry.crash.seek(0)
            write_record(failed_record(entry.trial, reason, _crash_text(entry.crash.read())), path)
        entry.crash.close()
        return Done.of(entry.trial, json.loads(path.read_text(encoding="utf-8")))


UNFIT = 97  # exit code of a child that cannot even begin
_CHILD = f"""
import os, pathlib, pickle, sys
try:
    from mr_experiments import sweep
    trial, snapshot_period = pickle.load(sys.stdin.buffer)
except Exception as error:
    print(f"{{type(error).__name__}}: {{error}}", file=sys.stderr)
    sys.exit({UNFIT})
folder, parent = pathlib.Path(sys.argv[1]), int(sys.argv[2])
sweep._run_as_child(trial, folder, snapshot_period, parent, sys.stderr.buffer)
"""

Answer = Tuple[Optional[int], bytes, bytes]
"""Of a worker: exit code (None: it took too long), the record if there is one, what was written to stderr."""


def remote_call() -> Callable[[bytes, float], Answer]:
    """What a worker does with a trial: a Python of its own, which the worker's other threads do not disturb and which
    cannot harm the worker. A nested function travels as code and not as a name, so that a worker without this software
    can still say what it lacks."""
    code = _CHILD

    def run_apart(request: bytes, longest: float) -> Answer:
        import os
        import pathlib
        import subprocess
        import sys
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            try:
                child = subprocess.run(
                    [sys.executable, "-c", code, folder, str(os.getpid())],
                    input=request, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, timeout=longest, check=False,
                )  # fmt: skip
            except subprocess.TimeoutExpired:
                return None, b"", b""
            records = [path.read_bytes() for path in pathlib.Path(folder).glob("*.json")]
            return child.returncode, b"".join(records), child.stderr

    return run_apart


class DaskCluster:
    """The same trials on the workers of a Dask scheduler. Records come back as values and are written here, so that
    the workers need this software and the worlds, but no folder in common."""

    def __init__(self, scheduler: str, snapshot_period: float = math.inf, longest: float = LONGEST) -> None:
        """Raises TrialError if Dask is not installed or the scheduler does not answer."""
        try:
            import distributed
        except ImportError:
            raise TrialError(
                "--scheduler needs Dask's distributed: apt-get install python3-distributed, here and on the workers"
            ) from None
        _check_address(scheduler)
        _silence("distributed")  # what matters of it is told here
        self._distributed, self._scheduler = distributed, scheduler
        self._snapshot_period, self._longest = snapshot_period, longest
        try:
            self._client = distributed.Client(scheduler, timeout=ANSWER_PATIENCE, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise TrialError(f"--scheduler {scheduler}: {' '.join(str(error).split())}") from None

    def close(self) -> None:
        """Lets go of the cluster; it stays as it is. What runs there comes to its end and is thrown away."""
        self._client.close(timeout=2.0)

    def run(self, trials: Sequence[Trial], folder: Path, tell: Tell = lambda _, __: None) -> Iterator[Done]:
        """Yields each trial when its record is written. A worker that dies loses nothing: others take over. Raises
        ClusterLostError if the scheduler is lost or no worker can run trials."""
        ended: queue.SimpleQueue[Any] = queue.SimpleQueue()
        requests = [pickle.dumps((trial, self._snapshot_period)) for trial in trials]
        futures = self._client.map(remote_call(), requests, longest=self._longest, pure=False)
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

    def _record_of(self, future: Any, trial: Trial) -> dict[str, Any]:
        try:
            if future.status in ("cancelled", "lost"):
                raise ConnectionError("the connection broke")
            error = future.exception(timeout=ANSWER_PATIENCE)
            if error is None:
                return self._record_from(future.result(timeout=LONGEST), trial)
        except ClusterLostError:
            raise
        except Exception as fault:
            raise self._lost(fault) from None
        if isinstance(error, self._distributed.KilledWorker):
            return failed_record(trial, f"several workers died of it: {error}")
        raise self._unfit(f"{type(error).__name__}: {error}")

    def _record_from(self, answer: Answer, trial: Trial) -> dict[str, Any]:
        code, written, told = answer
        if code is None:
            return failed_record(trial, _took_too_long(self._longest))
        if code == UNFIT:
            raise self._unfit(told.decode(errors="replace").strip())
        if not written:
            return failed_record(trial, _how_it_ended(code), _crash_text(told))
        record: dict[str, Any] = json.loads(written)
        return record

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


def default_jobs() -> int:
    """As many as this process may use cores."""
    return len(os.sched_getaffinity(0))
