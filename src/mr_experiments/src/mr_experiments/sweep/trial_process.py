"""The process of one trial: how it runs, and what is said of it if it ends without a record."""

from __future__ import annotations

import faulthandler
import math
import os
import signal
import struct
import threading
import time
import traceback
from pathlib import Path
from typing import IO

from mr_experiments.sweep.record import own_versions, run_trial
from mr_experiments.trial.trial import Trial
from mr_measures.record.files import write_record
from mr_measures.record.mission_record import FAILED, Asked, MissionRecord, Outcome

PATIENCE = 600.0  # s of real time that a trial may stand still
NOT_WRITTEN = 74  # exit code of a trial whose record cannot be written (EX_IOERR)


def record_path(folder: Path, trial: Trial) -> Path:
    return folder / f"{trial.key}.json"


def failed_record(trial: Trial, reason: str, trace: str = "", time: float = 0.0) -> MissionRecord:
    """Of a trial that left none itself and ended at this virtual time in s."""
    outcome = Outcome(FAILED, round(time, 3), reason, trace)
    return MissionRecord(Asked(trial.to_json()), outcome, versions=own_versions())


class ClockFile:
    """The virtual time that a trial has come to, in a file, so that it is known when its process is no more."""

    def __init__(self, path: Path) -> None:
        self.time = 0.0  # s
        self._file = path.open("wb+", buffering=0)

    def write(self, time: float) -> None:
        self.time = time
        os.pwrite(self._file.fileno(), struct.pack("d", time), 0)


class HangWatch:
    """Ends this process if virtual time stands still for `patience` s of real time, and writes to `crash` where it was.

    Works also while compiled code runs. As missions have a limit in virtual time, all of them come to an end.
    """

    def __init__(self, crash: IO[bytes], patience: float) -> None:
        self._crash, self._patience = crash, patience
        self._time, self._armed_at = -math.inf, -math.inf
        self.progress(0.0)

    def progress(self, virtual: float) -> None:
        """Virtual time in s, the more often the better."""
        now = time.monotonic()
        if virtual > self._time and now - self._armed_at > 0.1 * self._patience:
            self._time, self._armed_at = virtual, now
            faulthandler.dump_traceback_later(self._patience, exit=True, file=self._crash)


def read_clock(octets: bytes) -> float:
    """What a ClockFile holds, in s; 0 if it holds nothing."""
    return float(struct.unpack("d", octets)[0]) if len(octets) == struct.calcsize("d") else 0.0


def _record_of(trial: Trial, snapshot_period: float, clock: ClockFile, watch: HangWatch) -> MissionRecord:
    def progress(virtual: float) -> None:
        clock.write(virtual)
        watch.progress(virtual)

    try:
        return run_trial(trial, snapshot_period, progress)
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        return failed_record(trial, reason, traceback.format_exc(), clock.time)


def _write(record: MissionRecord, trial: Trial, folder: Path, time: float) -> None:
    """Raises OSError."""
    path = record_path(folder, trial)
    try:
        write_record(record, path)
    except ValueError as error:  # a number that JSON does not have
        write_record(failed_record(trial, f"ValueError: {error}", traceback.format_exc(), time), path)


def run_as_child(
    trial: Trial, folder: Path, snapshot_period: float, patience: float, parent: int, crash: IO[bytes], clock: Path
) -> None:
    """The whole life of a process that runs one trial. Ctrl-C is the parent's affair; without it there is no use.
    Where an engine crashes or hangs, or why the record cannot be written, goes to `crash`, the virtual time to the file
    `clock`."""
    faulthandler.enable(crash, all_threads=False)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_without, args=(parent,), daemon=True).start()
    told = ClockFile(clock)
    record = _record_of(trial, snapshot_period, told, HangWatch(crash, patience))
    try:
        _write(record, trial, folder, told.time)
    except OSError as error:
        crash.write(str(error.strerror).encode())
        crash.flush()
        os._exit(NOT_WRITTEN)


def _end_without(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)


def how_it_ended(code: int | None, told: str, patience: float) -> str:
    """In words, of a process that left no record; `told`: its crash text. Negative: the signal that ended it."""
    if told.startswith("Timeout ("):
        return f"made no progress for {patience:g} s of real time and was ended"
    if code is None or code >= 0:
        return f"its process ended with exit code {code}"
    name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
    hint = " (out of memory?)" if -code == signal.SIGKILL else ""
    return f"its process was ended by {name}{hint}"


def crash_text(told: bytes) -> str:
    """Of what Python's faulthandler writes: where it happened, without the list of all modules."""
    return told.decode(errors="replace").split("\nExtension modules")[0][:4000]
