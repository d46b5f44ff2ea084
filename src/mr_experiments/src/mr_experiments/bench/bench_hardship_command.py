"""Command line of ``rosrun mr_experiments bench_hardship``."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Sequence

from rich.console import Console

from mr_experiments.bench.bench_hardship import HARDSHIPS, LARGE, table, trials_of
from mr_experiments.bench.bench_merging import text_of
from mr_experiments.bench.mission_set import records_of_all
from mr_experiments.common.command_line import BAD_CALL, INTERRUPTED, CallError, Parser
from mr_experiments.sweep.sweep import default_jobs
from mr_experiments.trial.trial import TrialError


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="bench_hardship",
        description="Whether teams finish, and how much later, in virtual time: error-free, with 30 % of the frames "
        "lost, a radio of 8 m, a robot that dies, a partition of a minute, and on a floor of 60 m x 60 m. A run that "
        "was stopped goes on where it was; missions of other code are run again.",
        epilog="Exit code: 0 every bar holds, 1 some do not, 2 bad call, 130 interrupted.",
    )
    add = parser.add_argument
    add("--out", type=Path, default=Path("out/bench/hardship.json"), metavar="FILE", help="for the rows (default: "
        "%(default)s); the records go into a folder of that name beside it")  # fmt: skip
    names = [*HARDSHIPS, LARGE]
    add("--only", nargs="+", choices=names, default=names, help="scenarios to run (default: all)")
    add("--trials", type=int, default=20, metavar="N", help="missions for each scenario (default: %(default)s)")
    add("--large-trials", type=int, default=1, metavar="N", help="missions on the large floor for each team size "
        "(default: %(default)s)")  # fmt: skip
    add("--first-seed", type=int, default=9001, metavar="S", help="(default: %(default)s)")
    add("--jobs", type=int, default=default_jobs(), metavar="N", help="missions at a time (default: the cores, "
        "%(default)s)")  # fmt: skip
    return parser


def main(arguments: Sequence[str]) -> int:
    try:
        options = make_parser().parse_args(arguments)
        _check(options)
        return _run(options)
    except (CallError, TrialError, OSError) as error:
        print(f"bench_hardship: {error}", file=sys.stderr)
        return BAD_CALL
    except KeyboardInterrupt:
        print("bench_hardship: interrupted; the same command goes on from here", file=sys.stderr)
        return INTERRUPTED


def _check(options: argparse.Namespace) -> None:
    for name, least in (("trials", 1), ("large_trials", 1), ("first_seed", 0), ("jobs", 1)):
        if getattr(options, name) < least:
            raise CallError(f"--{name.replace('_', '-')} {getattr(options, name)} must be at least {least}")


def _run(options: argparse.Namespace) -> int:
    console = Console(soft_wrap=True, emoji=False, width=None if sys.stdout.isatty() else 120)
    first = options.first_seed
    trials = trials_of(options.only, range(first, first + options.trials), range(first, first + options.large_trials))
    rows = table(records_of_all(trials, options.out.with_suffix(""), options.jobs, console))
    for entry in rows:
        console.print(text_of(entry), highlight=False, markup=False)
    options.out.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    return 0 if all(entry["holds"] for entry in rows) else 1
