"""Many trials: which there are, which are done already, and who runs them."""

from __future__ import annotations

import json
import math
import multiprocessing
import multiprocessing.connection
import os
import time
from dataclasses import dataclass
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Iterable, Iterator, Protocol, Sequence

from mr_experiments.record import FORMAT, run_trial, versions, write_record
from mr_experiments.trial import Trial, TrialError

LONGEST = 3600.0  # s of real time for one trial


@dataclass(frozen=True)
class Done:
    """A trial whose record is written."""

    trial: Trial
    record: dict[str, Any]

    @property
    def status(self) -> str:
        return str(self.record["outcome"]["status"])


def record_path(folder: Path, trial: Trial) -> Path:
    return folder / f"{trial.key}.json"


def split_done(trials: Iterable[Trial], folder: Path) -> tuple[list[Trial], list[Done]]:
    """What is left to do, and what an earlier run has recorded. Raises TrialError for a record of another trial."""
    left: list[Trial] = []
    done: list[Done] = []
    for trial in trials:
        path = record_path(folder, trial)
        if not path.exists():
            left.append(trial)
            continue
        try:
            record = json.loads(path.read_text(encoding="utf-8"))
            same = record["trial"] == json.loads(json.dumps(trial.to_json()))
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise TrialError(f"{path} is no record ({error}); remove it to run the trial again") from None
        if not same:
            raise TrialError(f"{path} is the record of another trial; choose another --out or remove it")
        done.append(Done(trial, record))
    return left, done


def failed_record(trial: Trial, reason: str) -> dict[str, Any]:
    """Of a trial that left none itself."""
    return {
        "format": FORMAT,
        "trial": trial.to_json(),
        "versions": versions(),
        "outcome": {"status": "failed", "reason": reason, "time": 0.0},
        "team": {"exploration_time": None, "series": {"time": [], "explored": [], "coverage": []}},
        "robots": {},
        "maps": {},
        "snapshots": [],
    }


def _run_and_write(trial: Trial, folder: Path, snapshot_period: float) -> None:
    write_record(run_trial(trial, snapshot_period), record_path(folder, trial))


class Runner(Protocol):
    """Who runs trials and writes their records."""

    def run(self, trials: Sequence[Trial], folder: Path) -> Iterator[Done]:
        """Yields each trial when its record is written."""


class LocalPool:
    """Each trial in a process of its own, so that none can harm another; `jobs` at a time."""

    def __init__(self, jobs: int, snapshot_period: float = math.inf, longest: float = LONGEST) -> None:
        self._jobs, self._snapshot_period, self._longest = jobs, snapshot_period, longest
        # What this process has loaded and computed is there in each of them at once.
        self._context = multiprocessing.get_context("fork")

    def run(self, trials: Sequence[Trial], folder: Path) -> Iterator[Done]:
        """Yields each trial when its record is written."""
        waiting = list(trials)
        running: dict[int, tuple[BaseProcess, Trial, float]] = {}
        try:
            while waiting or running:
                while waiting and len(running) < self._jobs:
                    self._begin(waiting.pop(0), folder, running)
                multiprocessing.connection.wait([process.sentinel for process, _, _ in running.values()], 0.5)
                for pid in [pid for pid, entry in running.items() if self._over(entry)]:
                    process, trial, _ = running.pop(pid)
                    yield self._end(process, trial, folder)
        finally:
            for process, _, _ in running.values():
                process.kill()
                process.join()

    def _begin(self, trial: Trial, folder: Path, running: dict[int, tuple[BaseProcess, Trial, float]]) -> None:
        process = self._context.Process(target=_run_and_write, args=(trial, folder, self._snapshot_period), daemon=True)
        process.start()
        assert process.pid is not None
        running[process.pid] = (process, trial, time.monotonic() + self._longest)

    @staticmethod
    def _over(entry: tuple[BaseProcess, Trial, float]) -> bool:
        process, _, deadline = entry
        if process.is_alive() and time.monotonic() > deadline:
            process.kill()
            process.join()
        return not process.is_alive()

    def _end(self, process: BaseProcess, trial: Trial, folder: Path) -> Done:
        process.join()
        path = record_path(folder, trial)
        if not path.exists():
            reason = f"its process ended with exit code {process.exitcode}"
            if process.exitcode == -9:
                reason = f"its process was killed, or took longer than {self._longest:.0f} s"
            write_record(failed_record(trial, reason), path)
        return Done(trial, json.loads(path.read_text(encoding="utf-8")))


class DaskCluster:
    """The same trials on the workers of a Dask scheduler; records come back and are written here."""

    def __init__(self, scheduler: str, snapshot_period: float = math.inf) -> None:
        """Raises TrialError if Dask is not installed or the scheduler does not answer."""
        try:
            from distributed import Client
        except ImportError:
            raise TrialError("--scheduler needs Dask: install the package python3-distributed") from None
        self._snapshot_period = snapshot_period
        try:
            self._client = Client(scheduler, timeout="10s")
        except (OSError, ValueError) as error:
            raise TrialError(f"--scheduler {scheduler}: {error}") from None

    def run(self, trials: Sequence[Trial], folder: Path) -> Iterator[Done]:
        """Yields each trial when its record is written. A worker that dies loses nothing: others take over."""
        from distributed import as_completed

        futures = {
            self._client.submit(run_trial, trial, self._snapshot_period, pure=False, retries=2): trial
            for trial in trials
        }
        for future in as_completed(list(futures)):
            trial = futures[future]
            try:
                record = future.result()
            except Exception as error:
                record = failed_record(trial, f"{type(error).__name__}: {error}")
            write_record(record, record_path(folder, trial))
            yield Done(trial, record)


def default_jobs() -> int:
    """As many as this process may use cores."""
    return len(os.sched_getaffinity(0))
