"""Command line of ``rosrun mr_experiments bench hardship``."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Sequence

from rich.console import Console

from mr_experiments.bench.bench_hardship import HARDSHIPS, LARGE, table, trials_of
from mr_experiments.bench.mission_benchmark import (
    EXIT_CODES,
    add_seed_and_jobs,
    check_least,
    conclude,
    run_benchmark,
    tell,
)
from mr_experiments.bench.mission_set import records_of_all
from mr_experiments.common.command_line import Parser


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="bench hardship",
        description="Whether teams finish, and how much later, in virtual time: error-free, with 30 % of the frames "
        "lost, a radio of 8 m, a robot that dies, a partition of a minute, and on a floor of 60 m x 60 m. A run that "
        "was stopped goes on where it was; missions of other code are run again.",
        epilog=EXIT_CODES,
    )
    add = parser.add_argument
    add("--out", type=Path, default=Path("out/bench/hardship.json"), metavar="FILE", help="for the rows (default: "
        "%(default)s); the records go into a folder of that name beside it")  # fmt: skip
    names = [*HARDSHIPS, LARGE]
    add("--only", nargs="+", choices=names, default=names, help="scenarios to run (default: all)")
    add("--trials", type=int, default=20, metavar="N", help="missions for each scenario (default: %(default)s)")
    add("--large-trials", type=int, default=1, metavar="N", help="missions on the large floor for each team size "
        "(default: %(default)s)")  # fmt: skip
    add_seed_and_jobs(parser, 9001)
    return parser


def main(arguments: Sequence[str]) -> int:
    return run_benchmark(make_parser(), _run, arguments)


def _run(options: argparse.Namespace, console: Console) -> int:
    check_least(options, trials=1, large_trials=1, first_seed=0, jobs=1)
    first = options.first_seed
    trials = trials_of(options.only, range(first, first + options.trials), range(first, first + options.large_trials))
    rows = table(records_of_all(trials, options.out.with_suffix(""), options.jobs, console))
    tell(rows, console)
    return conclude(rows, options.out)
