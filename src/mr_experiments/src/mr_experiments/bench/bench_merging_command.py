"""Command line of ``rosrun mr_experiments bench_merging``."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections import Counter
from pathlib import Path
from typing import Sequence

from rich.console import Console

from mr_experiments.bench.bench_merging import PARTS, Part, Request, Row, records_of, text_of, wrong_row
from mr_experiments.bench.merge_times import all_settled_at, classes_of_pairs
from mr_experiments.common.command_line import BAD_CALL, INTERRUPTED, CallError, Parser
from mr_experiments.sweep.following import follow, line_of
from mr_experiments.sweep.sweep import Done, LocalPool, default_jobs, left_for_this_code
from mr_experiments.sweep.trial_process import record_path
from mr_experiments.trial.trial import TrialError
from mr_measures.record.files import read_record
from mr_measures.record.mission_record import MissionRecord


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="bench_merging",
        description="How soon teams know where their members are, and whether they are ever wrong, in missions in "
        "virtual time. A run that was stopped goes on where it was; missions of other code are run again.",
        epilog="Exit code: 0 every bar holds, 1 some do not, 2 bad call, 130 interrupted.",
    )
    add = parser.add_argument
    add("--out", type=Path, default=Path("out/bench/merging.json"), metavar="FILE", help="for the rows (default: "
        "%(default)s); the records go into a folder of that name beside it")  # fmt: skip
    add("--only", nargs="+", choices=list(PARTS), default=list(PARTS), help="parts to run (default: all)")
    add("--seeds", type=int, default=40, metavar="N", help="missions for each team size (default: %(default)s)")
    add("--first-seed", type=int, default=1001, metavar="S", help="(default: %(default)s)")
    add("--until", type=float, default=60.0, metavar="S", help="s of virtual time after which missions end that are "
        "only to meet; Turtlebots have twice as long (default: %(default)g)")  # fmt: skip
    add("--jobs", type=int, default=default_jobs(), metavar="N", help="missions at a time (default: the cores, "
        "%(default)s)")  # fmt: skip
    return parser


def main(arguments: Sequence[str]) -> int:
    try:
        options = make_parser().parse_args(arguments)
        _check(options)
        return _run(options)
    except (CallError, TrialError, OSError) as error:
        print(f"bench_merging: {error}", file=sys.stderr)
        return BAD_CALL
    except KeyboardInterrupt:
        print("bench_merging: interrupted; the same command goes on from here", file=sys.stderr)
        return INTERRUPTED


def _check(options: argparse.Namespace) -> None:
    for name, least in (("seeds", 1), ("first_seed", 0), ("jobs", 1)):
        if getattr(options, name) < least:
            raise CallError(f"--{name.replace('_', '-')} {getattr(options, name)} must be at least {least}")
    if not (options.until > 0.0 and math.isfinite(options.until)):
        raise CallError(f"--until {options.until:g} must be a positive number of seconds")


def _run(options: argparse.Namespace) -> int:
    request = Request(range(options.first_seed, options.first_seed + options.seeds), options.until)
    console = Console(soft_wrap=True, emoji=False, width=None if sys.stdout.isatty() else 120)
    rows: list[Row] = []
    everything: list[MissionRecord] = []
    for name in options.only:
        records = _records(PARTS[name], request, options, console)
        everything += [record for of_size in records.values() for record in of_size]
        rows += _told(PARTS[name].rows(records), console)
    rows += _told([wrong_row(everything)], console)
    options.out.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    return 0 if all(entry["holds"] for entry in rows) else 1


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


def _told(rows: list[Row], console: Console) -> list[Row]:
    for entry in rows:
        console.print(text_of(entry), highlight=False, markup=False)
    return rows
