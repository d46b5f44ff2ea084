"""Many trials: which there are, which are done already, and who runs them."""

from __future__ import annotations

import contextlib
import json
import math
import multiprocessing
import multiprocessing.connection
import os
import tempfile
from dataclasses import dataclass
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import IO, Any, Callable, Iterable, Iterator, Mapping, Protocol, Sequence

import cv2

from mr_experiments.common.code_version import code_version
from mr_experiments.host.recorder import truth_for
from mr_experiments.sweep.trial_process import (
    NOT_WRITTEN,
    PATIENCE,
    crash_text,
    failed_record,
    how_it_ended,
    read_clock,
    record_path,
    run_as_child,
)
from mr_experiments.trial.trial import Trial, TrialError
from mr_experiments.trial.trial_world import world_of
from mr_measures.record.files import RecordError, read_record, write_record
from mr_measures.record.mission_record import FAILED, MissionRecord
from mr_sim.world_names import name_of

TELL_PERIOD = 0.5  # s of real time between two words on how it goes

Tell = Callable[[int, str], None]
"""Called while trials run: how many do, and what holds them up ("" if nothing does)."""


@dataclass(frozen=True)
class Done:
    """What a sweep tells of a trial whose record is written."""

    trial: Trial
    status: str
    reason: str
    exploration_time: float | None  # s
    map_errors: tuple[float, ...]  # percent, of the robots that have one
    real_time_factor: float | None
    code: str  # that made it (code_version); "" if it does not say

    @classmethod
    def of(cls, trial: Trial, record: MissionRecord) -> Done:
        return cls(
            trial, record.outcome.status, record.outcome.reason, record.team.exploration_time, record.map_errors,
            record.measured.real_time_factor, record.code,
        )  # fmt: skip


def split_done(trials: Iterable[Trial], folder: Path, retry_failed: bool = False) -> tuple[list[Trial], list[Done]]:
    """What is left to do, and what an earlier run has recorded. `retry_failed`: trials that crashed, hung or were
    killed are to be done again. Raises TrialError for a record of another trial."""
    left: list[Trial] = []
    done: list[Done] = []
    for trial in trials:
        path = record_path(folder, trial)
        entry = _read_done(trial, path) if path.exists() else None
        if entry is None or (retry_failed and entry.status == FAILED):
            left.append(trial)
        else:
            done.append(entry)
    return left, done


def left_for_this_code(trials: Sequence[Trial], folder: Path) -> list[Trial]:
    """Those that have no record made by the code that is here; records of other code are removed."""
    left, done = split_done(trials, folder, retry_failed=True)
    other = [entry.trial for entry in done if entry.code != code_version()]
    for trial in other:
        record_path(folder, trial).unlink()
    return left + other


def _read_done(trial: Trial, path: Path) -> Done:
    try:
        record = read_record(path)
    except RecordError as error:
        raise TrialError(f"{error}; choose another --out or remove it to run the trial again") from None
    recorded = {**record.asked.settings, "world": name_of(record.asked.world)}  # older ones have it as it was given
    asked = json.loads(json.dumps(trial.to_json()))
    if recorded != asked:
        raise TrialError(
            f"{path} is the record of another trial ({_difference(recorded, asked)}); choose another --out or remove it"
        )
    return Done.of(trial, record)


def _difference(recorded: Mapping[str, Any], asked: Mapping[str, Any]) -> str:
    key = next(key for key in {**asked, **recorded} if asked.get(key) != recorded.get(key))
    return f"{key}: {recorded.get(key)!r}, not {asked.get(key)!r}"


class Runner(Protocol):
    """Who runs trials and writes their records."""

    def run(self, trials: Sequence[Trial], folder: Path, tell: Tell = ...) -> Iterator[Done]:
        """Yields each trial when its record is written."""


@dataclass
class _Running:
    process: BaseProcess
    trial: Trial
    crash: IO[bytes]
    clock: IO[bytes]


class LocalPool:
    """Each trial in a process of its own, so that none can harm another; `jobs` at a time."""

    def __init__(self, jobs: int, snapshot_period: float = math.inf, patience: float = PATIENCE) -> None:
        """`patience`: s of real time after which a trial whose virtual time stands still is ended."""
        self._jobs, self._snapshot_period, self._patience = jobs, snapshot_period, patience
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
                for entry in [entry for entry in running if not entry.process.is_alive()]:
                    running.remove(entry)
                    yield self._end(entry, folder)
        finally:
            for entry in running:
                entry.process.kill()
                entry.process.join()

    def _begin(self, trial: Trial, folder: Path) -> _Running:
        remove_failed(record_path(folder, trial))
        with contextlib.suppress(Exception):  # the trial itself says what is wrong with its world
            truth_for(trial, world_of(trial))
        crash = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the process
        clock = tempfile.NamedTemporaryFile()  # noqa: SIM115 - same
        arguments = (trial, folder, self._snapshot_period, self._patience, os.getpid(), crash, Path(clock.name))
        process = self._context.Process(target=run_as_child, args=arguments, daemon=True)
        process.start()
        return _Running(process, trial, crash, clock)

    def _end(self, entry: _Running, folder: Path) -> Done:
        entry.process.join()
        path = record_path(folder, entry.trial)
        if entry.process.exitcode == NOT_WRITTEN:
            entry.crash.seek(0)
            raise OSError(f"{path} cannot be written: {crash_text(entry.crash.read())}")
        if not path.exists():
            entry.crash.seek(0)
            told, clock = crash_text(entry.crash.read()), read_clock(entry.clock.read())
            reason = how_it_ended(entry.process.exitcode, told, self._patience)
            write_record(failed_record(entry.trial, reason, told, clock), path)
        entry.crash.close()
        entry.clock.close()
        return Done.of(entry.trial, read_record(path))


def remove_failed(path: Path) -> None:
    """The record of a failed trial that is done again. What another run has recorded meanwhile stays until it is
    replaced."""
    with contextlib.suppress(OSError, RecordError):
        if read_record(path).failed:
            path.unlink()


def default_jobs() -> int:
    """As many as this process may use cores."""
    return len(os.sched_getaffinity(0))
