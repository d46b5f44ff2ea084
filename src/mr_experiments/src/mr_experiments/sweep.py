"""Many trials: which there are, which are done already, and who runs them."""

from __future__ import annotations

import json
import logging
import math
import multiprocessing
import multiprocessing.connection
import os
import pickle
import queue
import signal
import subprocess
import sys
import tempfile
import threading
import time
import traceback
from dataclasses import dataclass
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Callable, Iterable, Iterator, Protocol, Sequence

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


def _run_as_child(trial: Trial, folder: Path, snapshot_period: float, parent: int) -> None:
    """The whole life of a process that runs one trial. Ctrl-C is the parent's affair; without it there is no use."""
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


def _took_too_long(longest: float) -> str:
    return f"took longer than {longest:g} s of real time and was ended"


@dataclass
class _Running:
    process: BaseProcess
    trial: Trial
    deadline: float  # s, monotonic
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
        arguments = (trial, folder, self._snapshot_period, os.getpid())
        process = self._context.Process(target=_run_as_child, args=arguments, daemon=True)
        process.start()
        return _Running(process, trial, time.monotonic() + self._longest)

    def _end(self, entry: _Running, folder: Path) -> Done:
        entry.process.join()
        path = record_path(folder, entry.trial)
        if not path.exists():
            reason = _took_too_long(self._longest) if entry.late else _how_it_ended(entry.process.exitcode)
            write_record(failed_record(entry.trial, reason), path)
        return Done.of(entry.trial, json.loads(path.read_text(encoding="utf-8")))


_SERVE = "import pickle, sys; from mr_experiments import sweep; sweep._run_as_child(*pickle.load(sys.stdin.buffer))"


def run_apart(trial: Trial, snapshot_period: float, longest: float) -> dict[str, Any]:
    """The record of a trial that runs in a Python of its own: for workers, whose other threads would disturb it and
    which it must not harm. Ends it after `longest` s of real time."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        request = pickle.dumps((trial, folder, snapshot_period, os.getpid()))
        try:
            child = subprocess.run(
                [sys.executable, "-c", _SERVE],
                input=request, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, timeout=longest, check=False,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return failed_record(trial, _took_too_long(longest))
        path = record_path(folder, trial)
        if path.exists():
            record: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
            return record
        return failed_record(trial, _how_it_ended(child.returncode), child.stderr.decode(errors="replace")[-2000:])


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
        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what matters of it is told here
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
        futures = self._client.map(
            run_apart, list(trials), snapshot_period=self._snapshot_period, longest=self._longest, pure=False
        )
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

    def _state(self, waiting: int) -> tuple[int, str]:
        """Of the cluster: how many trials run, and what holds them up."""
        try:
            threads = self._client.sync(self._client.scheduler.ncores, callback_timeout=ANSWER_PATIENCE)
        except Exception as error:
            raise self._lost(error) from None
        running = min(waiting, sum(threads.values()))
        return running, "" if threads else f"{self._scheduler} has no workers: waiting for one"

    def _record_of(self, future: Any, trial: Trial) -> dict[str, Any]:
        try:
            if future.status in ("cancelled", "lost"):
                raise ConnectionError("it cancelled the trials")
            error = future.exception(timeout=ANSWER_PATIENCE)
            if error is None:
                record: dict[str, Any] = future.result(timeout=LONGEST)
                return record
        except Exception as fault:
            raise self._lost(fault) from None
        told = f"{type(error).__name__}: {error}"
        if isinstance(error, self._distributed.KilledWorker):
            return failed_record(trial, f"several workers died of it: {told}")
        raise ClusterLostError(f"a worker of {self._scheduler} cannot run trials: {told}")

    def _lost(self, error: Exception) -> ClusterLostError:
        told = " ".join(str(error).split()) or type(error).__name__
        return ClusterLostError(f"the scheduler {self._scheduler} is lost ({told})")


def default_jobs() -> int:
    """As many as this process may use cores."""
    return len(os.sched_getaffinity(0))
