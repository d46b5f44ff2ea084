"""The references of maps: how much one robot alone explores in a world, in missions of this host."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Callable, Sequence

from mr_experiments.common.code_version import code_version
from mr_experiments.sweep.record import SLAM
from mr_experiments.sweep.sweep import LocalPool
from mr_experiments.sweep.trial_process import record_path
from mr_experiments.trial.trial import Trial, TrialError
from mr_measures.record.files import read_record
from mr_measures.record.mission_record import FINISHED
from mr_measures.reference import VIRTUAL_TIME, MapReferenceError, Reference, load_reference

RESOLUTION = 0.05  # m, of the maps of SLAM
TOLERANCE = 0.05  # percent; the same mission on another processor may flip a few cells

Progress = Callable[[int, int, float], None]
"""Seed, free cells and exploration time in s of a mission."""


def make_reference(
    world: str, seeds: Sequence[int], limit: float, jobs: int, progress: Progress = lambda *_: None
) -> Reference:
    """One-robot missions with these seeds, `jobs` at a time. Raises TrialError for one that does not finish within
    `limit` s."""
    trials = [Trial(world, 1, seed, scenario="reference", limit=limit) for seed in seeds]
    cells: dict[int, int] = {}
    with tempfile.TemporaryDirectory() as folder:
        for done in LocalPool(jobs).run(trials, Path(folder)):
            if done.status != FINISHED:
                raise TrialError(f"{world}, seed {done.trial.seed}: {done.reason}")
            (robot,) = read_record(record_path(Path(folder), done.trial)).robots.values()
            cells[done.trial.seed] = robot.map.free_cells or 0
            progress(done.trial.seed, cells[done.trial.seed], done.exploration_time or 0.0)
    return Reference(Path(world).stem, RESOLUTION, SLAM, VIRTUAL_TIME, code_version(), dict(sorted(cells.items())))


def deviation(world: Path, limit: float) -> float:
    """Percent by which the first mission of a world's stored reference, repeated here, has more free cells than are
    stored. Raises MapReferenceError if there is none of this host, TrialError if the mission does not finish."""
    reference = load_reference(world)
    if reference is None:
        raise MapReferenceError(f"{world} has no reference")
    if reference.host != VIRTUAL_TIME:
        raise MapReferenceError(f"the reference of {world} is of another host: {reference.host}, not {VIRTUAL_TIME}")
    seed, stored = min(reference.free_cells.items())
    repeated = make_reference(str(world), [seed], limit, jobs=1).free_cells[seed]
    return 100.0 * (repeated / stored - 1.0)
