"""Command line of ``rosrun mr_experiments run``."""

from __future__ import annotations

import argparse
import math
import statistics
import sys
from pathlib import Path
from typing import NoReturn, Sequence

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from mr_experiments.mission import world_of
from mr_experiments.scenario import DEFAULT, Scenario, known_scenarios, load_scenario
from mr_experiments.sweep import DaskCluster, Done, LocalPool, Runner, default_jobs, split_done
from mr_experiments.trial import Trial, TrialError


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise TrialError(f"{message} (--help lists the options)")


def make_parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="run",
        description="Whole missions in virtual time: one JSON record per trial. A run that was stopped goes on where "
        "it was when it is started again.",
        epilog="Exit code: 0 every trial finished, 1 some did not (their records tell why), 2 bad options, "
        "130 interrupted. Then: rosrun mr_experiments report DIR, rosrun mr_experiments show DIR/RECORD.json.",
    )
    add = parser.add_argument
    add("--scenario", default=DEFAULT, metavar="NAME|FILE", help="what the trials have in common: "
        + ", ".join(known_scenarios()) + ", or a .yaml file (default: %(default)s)")  # fmt: skip
    add("--world", default="", metavar="NAME|FILE", help="instead of the scenario's world")
    add("--robots", type=int, nargs="+", metavar="R", help="team sizes (default: the scenario's)")
    add("--strategy", type=int, nargs="+", metavar="N", help="strategies (default: the scenario's)")
    add("--trials", type=int, default=40, metavar="N", help="trials for each team size (default: %(default)s)")
    add("--seed", type=int, default=1, metavar="N", help="of the first trial; each further one has the next "
        "(default: %(default)s)")  # fmt: skip
    add("--out", default="out/experiments", metavar="DIR", help="folder for the records (default: %(default)s)")
    add("--jobs", type=int, default=default_jobs(), metavar="N", help="trials at a time (default: the cores, "
        "%(default)s)")  # fmt: skip
    add("--scheduler", default="", metavar="tcp://HOST:PORT", help="run on a Dask cluster instead of here")
    add("--snapshots", type=float, default=math.inf, metavar="S", help="store the growing maps every S seconds, for "
        "show (default: only the last ones)")  # fmt: skip
    return parser


def plan(scenario: Scenario, arguments: argparse.Namespace) -> list[Trial]:
    """Seed by seed, so that a part of a sweep already compares all team sizes."""
    return [
        scenario.trial(robots, strategy, seed, arguments.world)
        for seed in range(arguments.seed, arguments.seed + arguments.trials)
        for strategy in arguments.strategy or scenario.strategies
        for robots in arguments.robots or scenario.robots
    ]


def main(argv: Sequence[str]) -> int:
    try:
        arguments = make_parser().parse_args(argv)
        return _run(arguments)
    except TrialError as error:
        print(f"run: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("run: interrupted; the same command goes on from here", file=sys.stderr)
        return 130


def _run(arguments: argparse.Namespace) -> int:
    for name, least in (("trials", 1), ("jobs", 1), ("seed", 0)):
        if getattr(arguments, name) < least:
            raise TrialError(f"--{name} {getattr(arguments, name)} must be at least {least}")
    if not arguments.snapshots > 0.0:
        raise TrialError(f"--snapshots {arguments.snapshots:g} must be a positive number of seconds")
    trials = plan(load_scenario(arguments.scenario), arguments)
    for trial in {(trial.world, trial.robots): trial for trial in trials}.values():
        world_of(trial)
    folder = Path(arguments.out)
    folder.mkdir(parents=True, exist_ok=True)
    left, done = split_done(trials, folder)
    console = Console(soft_wrap=True, width=None if sys.stdout.isatty() else 120)
    if done:
        console.print(f"{len(done)} of {len(trials)} trials are recorded in {folder} already.")
    runner: Runner = LocalPool(arguments.jobs, arguments.snapshots)
    if arguments.scheduler:
        runner = DaskCluster(arguments.scheduler, arguments.snapshots)
    done += _follow(runner, left, folder, console)
    _print_summary(console, done, folder)
    return 0 if all(entry.status == "finished" for entry in done) else 1


def _follow(runner: Runner, left: list[Trial], folder: Path, console: Console) -> list[Done]:
    done = []
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(),
               TextColumn("left"), TimeRemainingColumn())  # fmt: skip
    # Without a refreshing thread: processes are forked meanwhile.
    with Progress(*columns, console=console, auto_refresh=False, disable=not console.is_terminal) as progress:
        task = progress.add_task("trials", total=len(left))
        for entry in runner.run(left, folder):
            done.append(entry)
            progress.update(task, advance=1)
            progress.refresh()
            progress.console.print(_line(entry), highlight=False, markup=False)
    return done


def _line(entry: Done) -> str:
    outcome, measured = entry.record["outcome"], entry.record.get("measured", {})
    time = entry.record["team"].get("exploration_time")
    told = f"{time:.1f} s" if time is not None else f"{entry.status}: {outcome['reason']}"
    factor = measured.get("real_time_factor")
    return f"{entry.trial.key}: {told}" + (f"  ({factor:.1f} x real time)" if factor else "")


def _print_summary(console: Console, done: list[Done], folder: Path) -> None:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for title in ("robots", "strategy", "trials", "finished", "unfinished", "failed", "median time", "mean map error"):
        table.add_column(title, justify="right")
    groups: dict[tuple[int, int], list[Done]] = {}
    for entry in done:
        groups.setdefault((entry.trial.robots, entry.trial.strategy), []).append(entry)
    for (robots, strategy), entries in sorted(groups.items()):
        counts = [sum(entry.status == status for entry in entries) for status in ("finished", "unfinished", "failed")]
        times = [entry.record["team"]["exploration_time"] for entry in entries if entry.status == "finished"]
        errors = [
            robot["map"]["error"]
            for entry in entries
            for robot in entry.record["robots"].values()
            if robot["map"].get("error") is not None
        ]
        table.add_row(
            str(robots), str(strategy), str(len(entries)), *(str(count) for count in counts),
            f"{statistics.median(times):.1f} s" if times else "-",
            f"{statistics.mean(errors):+.2f} %" if errors else "-",
        )  # fmt: skip
    console.print(table)
    console.print(f"Records in {folder}. Next: rosrun mr_experiments report {folder}", highlight=False)
