"""Command line of ``rosrun mr_experiments bench explore``."""

from __future__ import annotations

import argparse
import multiprocessing
import time
from pathlib import Path
from typing import Callable, Sequence

from rich.console import Console

from mr_experiments.bench.bench_explore import BEST, MOST, NEAREST, table, text_table
from mr_experiments.bench.explore_missions import (
    LIMIT,
    Bounds,
    MissionRow,
    append,
    as_json,
    bounds_of,
    fast_trials_of,
    key_of,
    read_bounds,
    read_rows,
    row_of,
    trials_of,
    world_name,
)
from mr_experiments.bench.mission_benchmark import (
    EXIT_CODES,
    add_seed_and_jobs,
    check_least,
    conclude,
    run_benchmark,
    tell,
)
from mr_experiments.common.code_version import code_version
from mr_experiments.common.command_line import Parser
from mr_experiments.sweep.following import follow, line_of
from mr_experiments.sweep.sweep import Done, LocalPool
from mr_experiments.sweep.trial_process import record_path
from mr_experiments.trial.trial import Trial
from mr_measures.record.files import read_record


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="bench explore",
        description="Exploration of generated worlds that no constant was tuned on, in virtual time: what more robots "
        "bring, against what no team could beat and against the nearest frontier. A run that was stopped goes on where "
        "it was; missions of other code are run again.",
        epilog=EXIT_CODES,
    )
    add = parser.add_argument
    add("--out", type=Path, default=Path("out/bench/explore.json"), metavar="FILE", help="for the table (default: "
        "%(default)s); beside it lie a row for each mission (.jsonl), bounds and records")  # fmt: skip
    add("--worlds", type=int, default=30, metavar="N", help="worlds, one seed each (default: %(default)s)")
    add("--robots", type=int, nargs="+", default=[1, 2, MOST], metavar="R", help="team sizes (default: 1 2 4)")
    add("--strategies", type=int, nargs="+", default=[BEST, NEAREST], metavar="N", help="(default: 7 0)")
    add("--limit", type=float, default=LIMIT, metavar="S", help="s of virtual time (default: %(default)g)")
    add("--fast-worlds", type=int, default=10, metavar="N", help="worlds that are run in fast mode too, "
        "with some missions of the office (default: %(default)s)")  # fmt: skip
    add("--no-bounds", action="store_true", help="without what no team could beat, which takes half a minute a world")
    add("--only-table", action="store_true", help="run nothing; the table of the missions that are there")
    add_seed_and_jobs(parser, 5001)
    return parser


def main(arguments: Sequence[str]) -> int:
    return run_benchmark(make_parser(), _run, arguments)


def _run(options: argparse.Namespace, console: Console) -> int:
    check_least(options, worlds=1, fast_worlds=0, first_seed=0, jobs=1)
    seeds = range(options.first_seed, options.first_seed + options.worlds)
    trials = trials_of(seeds, options.robots, options.strategies, options.limit)
    trials += fast_trials_of(seeds[: options.fast_worlds], options.robots, BEST, options.limit)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    bounds: Bounds = {}
    if not options.no_bounds:
        bounds = _bounds([world_name(seed) for seed in seeds], options, console)
    rows = _missions(trials, options, console)
    for line in text_table(rows, bounds):
        console.print(line, highlight=False, markup=False)
    entries = table(rows, bounds)
    tell(entries, console)
    return conclude(entries, options.out)


def _missions(trials: Sequence[Trial], options: argparse.Namespace, console: Console) -> list[MissionRow]:
    """The rows of the trials that the present code has made, in their order."""
    path = options.out.with_suffix(".jsonl")
    done = _done(path)
    left = [trial for trial in trials if key_of(trial) not in done]
    console.print(f"{len(left)} of {len(trials)} missions to run", highlight=False)
    if left and not options.only_table:
        folder = options.out.with_suffix("")
        folder.mkdir(exist_ok=True)
        follow(LocalPool(options.jobs), left, folder, console, _keeper(path, folder, len(left)))
        done = _done(path)
    return [done[key_of(trial)] for trial in trials if key_of(trial) in done]


def _done(path: Path) -> dict[tuple, MissionRow]:
    """Missions that crashed or were killed are run again."""
    return {row.key: row for row in read_rows(path) if row.code == code_version() and row.status != "failed"}


def _keeper(path: Path, folder: Path, count: int) -> Callable[[Done], str]:
    """Appends a row for each mission that is done; tells how it went and when all will be."""
    begun, number = time.monotonic(), 0

    def keep(done: Done) -> str:
        nonlocal number
        number += 1
        append(path, as_json(row_of(read_record(record_path(folder, done.trial)))))
        left = (time.monotonic() - begun) / number * (count - number) / 60.0
        return f"{line_of(done)}; {number} of {count}, about {left:.0f} min left"

    return keep


def _bounds(worlds: Sequence[str], options: argparse.Namespace, console: Console) -> Bounds:
    path = options.out.with_suffix(".bounds.jsonl")
    known = read_bounds(path)
    left = [world for world in worlds if any((world, size) not in known for size in options.robots)]
    if left and not options.only_table:
        console.print(f"bounds of {len(left)} of {len(worlds)} worlds to compute", highlight=False)
        with multiprocessing.get_context("fork").Pool(options.jobs) as pool:
            for number, lines in enumerate(pool.imap_unordered(_Bounded(options.robots), left), 1):
                for line in lines:
                    append(path, line)
                console.print(f"{lines[0]['world']}: bound {number} of {len(left)}", highlight=False)
    return read_bounds(path)


class _Bounded:
    """`bounds_of` for the same team sizes, for another process."""

    def __init__(self, robots: Sequence[int]) -> None:
        self._robots = sorted(set(robots))

    def __call__(self, world: str) -> list[dict]:
        return bounds_of(world, self._robots)
