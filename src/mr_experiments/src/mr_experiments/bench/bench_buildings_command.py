"""Command line of ``rosrun mr_experiments bench buildings``."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Sequence

from rich.console import Console

from mr_experiments.bench.bench_buildings import KINDS, Group, table, trials_of
from mr_experiments.bench.mission_benchmark import (
    EXIT_CODES,
    add_seed_and_jobs,
    check_least,
    conclude,
    run_benchmark,
    tell,
)
from mr_experiments.bench.mission_set import records_of_all
from mr_experiments.common.command_line import CallError, Parser
from mr_measures.record.mission_record import BIAS, MissionRecord
from mr_sim.world import ODOMETRY_MODELS


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="bench buildings",
        description="Whether teams come to their end and home, touch nothing and draw right walls in narrow, wide, "
        "huge and generated buildings, with Turtlebots and in mixed teams, from anywhere, up to sixteen robots; in "
        "virtual time. A run that was stopped goes on where it was; missions of other code are run again.",
        epilog=EXIT_CODES,
    )
    add = parser.add_argument
    add("--out", type=Path, default=Path("out/bench/buildings.json"), metavar="FILE", help="for the rows (default: "
        "%(default)s); the records go into a folder of that name beside it")  # fmt: skip
    add("--only", nargs="+", choices=list(KINDS), default=list(KINDS), help="kinds of missions (default: all)")
    add("--robots", nargs="+", type=int, metavar="R", help="team sizes, of those that each kind has (default: all)")
    add("--trials", type=int, default=20, metavar="N", help="missions of each kind and team size (default: "
        "%(default)s)")  # fmt: skip
    add("--huge-trials", type=int, default=1, metavar="N", help="the same on the floor of 60 m x 60 m, a quarter of an "
        "hour and more each (default: %(default)s)")  # fmt: skip
    add("--odometry", nargs="+", choices=ODOMETRY_MODELS, default=[BIAS], help="how it errs: missions with each, and "
        f"rows named so (default: {BIAS})")  # fmt: skip
    add_seed_and_jobs(parser, 9301)
    return parser


def main(arguments: Sequence[str]) -> int:
    return run_benchmark(make_parser(), _run, arguments)


def _run(options: argparse.Namespace, console: Console) -> int:
    check_least(options, trials=1, huge_trials=1, first_seed=0, jobs=1)
    groups: dict[Group, list[MissionRecord]] = {}
    for odometry in options.odometry:
        groups |= _missions(options, odometry, console)
    rows = table(groups)
    tell(rows, console)
    return conclude(rows, options.out)


def _missions(options: argparse.Namespace, odometry: str, console: Console) -> dict[Group, list[MissionRecord]]:
    """With each odometry in a folder of its own, since the names of records do not tell them apart."""
    first, folder = options.first_seed, options.out.with_suffix("")
    seeds, huge = range(first, first + options.trials), range(first, first + options.huge_trials)
    groups = trials_of(options.only, seeds, huge, odometry)
    if options.robots:
        groups = {group: trials for group, trials in groups.items() if group.team in options.robots}
    if not groups:
        raise CallError(f"no team of {', '.join(options.only)} has {' or '.join(map(str, options.robots))} robots")
    trials = [trial for group in groups.values() for trial in group]
    where = folder if odometry == BIAS else folder / odometry
    records = iter(records_of_all(trials, where, options.jobs, console))
    return {key: [next(records) for _ in group] for key, group in groups.items()}
