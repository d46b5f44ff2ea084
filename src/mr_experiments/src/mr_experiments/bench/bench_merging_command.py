"""Command line of ``rosrun mr_experiments bench merging``."""

from __future__ import annotations

import argparse
import math
from collections import Counter
from pathlib import Path
from typing import Sequence

from rich.console import Console

from mr_experiments.bench.bench_merging import PARTS, Part, Request, records_of, wrong_row
from mr_experiments.bench.merge_times import all_settled_at, classes_of_pairs
from mr_experiments.bench.mission_benchmark import (
    EXIT_CODES,
    add_seed_and_jobs,
    check_least,
    conclude,
    run_benchmark,
    tell,
)
from mr_experiments.bench.rows import Row
from mr_experiments.common.command_line import CallError, Parser
from mr_experiments.sweep.following import follow, line_of
from mr_experiments.sweep.sweep import Done, LocalPool, left_for_this_code
from mr_experiments.sweep.trial_process import record_path
from mr_measures.record.files import read_record
from mr_measures.record.mission_record import MissionRecord


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="bench merging",
        description="How soon teams know where their members are, and whether they are ever wrong, in missions in "
        "virtual time. A run that was stopped goes on where it was; missions of other code are run again.",
        epilog=EXIT_CODES,
    )
    add = parser.add_argument
    add("--out", type=Path, default=Path("out/bench/merging.json"), metavar="FILE", help="for the rows (default: "
        "%(default)s); the records go into a folder of that name beside it")  # fmt: skip
    add("--only", nargs="+", choices=list(PARTS), default=list(PARTS), help="parts to run (default: all)")
    add("--seeds", type=int, default=40, metavar="N", help="missions for each team size (default: %(default)s)")
    add("--until", type=float, default=60.0, metavar="S", help="s of virtual time after which missions end that are "
        "only to meet; Turtlebots have twice as long (default: %(default)g)")  # fmt: skip
    add_seed_and_jobs(parser, 1001)
    return parser


def main(arguments: Sequence[str]) -> int:
    return run_benchmark(make_parser(), _run, arguments)


def _check(options: argparse.Namespace) -> None:
    check_least(options, seeds=1, first_seed=0, jobs=1)
    if not (options.until > 0.0 and math.isfinite(options.until)):
        raise CallError(f"--until {options.until:g} must be a positive number of seconds")


def _run(options: argparse.Namespace, console: Console) -> int:
    _check(options)
    request = Request(range(options.first_seed, options.first_seed + options.seeds), options.until)
    rows: list[Row] = []
    everything: list[MissionRecord] = []
    for name in options.only:
        records = _records(PARTS[name], request, options, console)
        everything += [record for of_size in records.values() for record in of_size]
        of_part = PARTS[name].rows(records)
        tell(of_part, console)
        rows += of_part
    wrong = wrong_row(everything)
    tell([wrong], console)
    return conclude([*rows, wrong], options.out)


def _records(
    part: Part, request: Request, options: argparse.Namespace, console: Console
) -> dict[int, list[MissionRecord]]:
    trials = part.trials(request)
    folder = options.out.with_suffix("") / f"{part.name}-{trials[0].limit:g}"
    folder.mkdir(parents=True, exist_ok=True)
    left = left_for_this_code(trials, folder)
    console.print(f"{part.name}: {len(left)} of {len(trials)} missions to run", highlight=False)
    follow(LocalPool(options.jobs), left, folder, console, lambda done: _line(done, folder))
    return records_of(trials, folder)


def _line(done: Done, folder: Path) -> str:
    if done.status == "failed" or done.trial.robots == 1:
        return line_of(done)
    record = read_record(record_path(folder, done.trial))
    time, kinds = all_settled_at(record), Counter(classes_of_pairs(record))
    merged = "never merged" if math.isinf(time) else f"merged after {time:.0f} s"
    return f"{done.trial.key}: {merged} ({', '.join(f'{count} {kind}' for kind, count in kinds.items())})"
