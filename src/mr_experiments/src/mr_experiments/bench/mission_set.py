"""Missions of a benchmark: run what is not there yet, and hand out the records of all."""

from __future__ import annotations

from pathlib import Path
from typing import Sequence

from rich.console import Console

from mr_experiments.sweep.following import follow, line_of
from mr_experiments.sweep.sweep import LocalPool, left_for_this_code
from mr_experiments.sweep.trial_process import record_path
from mr_experiments.trial.trial import Trial
from mr_measures.record.files import read_record
from mr_measures.record.mission_record import MissionRecord


def records_of_all(trials: Sequence[Trial], folder: Path, jobs: int, console: Console) -> list[MissionRecord]:
    """In the order of the trials. Missions of other code are run again."""
    folder.mkdir(parents=True, exist_ok=True)
    left = left_for_this_code(trials, folder)
    console.print(f"{len(left)} of {len(trials)} missions to run", highlight=False)
    follow(LocalPool(jobs), left, folder, console, line_of)
    return [read_record(record_path(folder, trial)) for trial in trials]
