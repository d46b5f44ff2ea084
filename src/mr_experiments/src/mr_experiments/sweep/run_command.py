"""Command line of ``rosrun mr_experiments run``."""

from __future__ import annotations

import argparse
import math
import signal
import statistics
import sys
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path
from shlex import quote
from types import FrameType
from typing import Iterator, Sequence

from rich.console import Console
from rich.table import Table

from mr_experiments.common.code_version import code_version
from mr_experiments.common.command_line import BAD_CALL, INTERRUPTED, CallError, Parser, strategy_number
from mr_experiments.host.recorder import truth_for
from mr_experiments.sweep.dask_cluster import ClusterLostError, DaskCluster
from mr_experiments.sweep.following import follow
from mr_experiments.sweep.sweep import Done, LocalPool, default_jobs, split_done
from mr_experiments.trial.scenario import DEFAULT, Scenario, known_scenarios, load_scenario
from mr_experiments.trial.trial import Trial, TrialError
from mr_experiments.trial.trial_world import most_robots, starts_fault, warning_of, world_of
from mr_sim.world import ODOMETRY_MODELS
from mr_sim.worlds import StartsError, starts_of

LARGEST_SEED = 2**31
LOST = 3  # exit code


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="run",
        description="Whole missions in virtual time: one JSON record per trial. A run that was stopped goes on where "
        "it was when it is started again.",
        epilog="Exit code: 0 every trial finished, 1 some did not (their records tell why), "
        "2 bad options, 3 the cluster or the folder was lost on the way, 130 interrupted. "
        "Then: rosrun mr_experiments report DIR, rosrun mr_experiments show DIR/RECORD.json.",
    )
    add = parser.add_argument
    add("--scenario", default=DEFAULT, metavar="NAME|FILE", help="what the trials have in common: "
        + ", ".join(known_scenarios()) + ", or a .yaml file (default: %(default)s)")  # fmt: skip
    add("--world", default="", metavar="NAME|FILE", help="instead of the scenario's world; a map's .yaml file is one, "
        "generated:KIND:SEED draws one (see plans)")  # fmt: skip
    add("--starts", type=float, nargs="+", default=[], metavar="X Y DEGREES", help="start poses of the robots, instead "
        "of the scenario's or the world's; a map has none of its own")  # fmt: skip
    add("--robots", type=int, nargs="+", metavar="R", help="team sizes (default: those of the scenario for which "
        "the world has robots)")  # fmt: skip
    add("--strategy", type=strategy_number, nargs="+", metavar="N|NAME", help="strategies (default: the scenario's)")
    add("--odometry", choices=ODOMETRY_MODELS, help="how it errs: by one share for the whole mission, or anew at each "
        "step (default: the scenario's)")  # fmt: skip
    add("--trials", type=int, default=40, metavar="N", help="trials for each team size (default: %(default)s)")
    add("--seed", type=int, default=1, metavar="N", help="of the first trial; each further one has the next "
        "(default: %(default)s)")  # fmt: skip
    add("--out", default="out/experiments", metavar="DIR", help="folder for the records (default: %(default)s)")
    add("--jobs", type=int, default=default_jobs(), metavar="N", help="trials at a time (default: the cores, "
        "%(default)s)")  # fmt: skip
    add("--scheduler", default="", metavar="tcp://HOST:PORT", help="run on a Dask cluster instead of here")
    add(
        "--retry-failed",
        action="store_true",
        help="do trials again whose records say that they crashed, hung or were killed",
    )
    add("--snapshots", type=float, default=math.inf, metavar="S", help="store the growing maps every S seconds, for "
        "show (default: only the last ones); not for trials that are recorded already")  # fmt: skip
    return parser


def plan(scenario: Scenario, arguments: argparse.Namespace) -> list[Trial]:
    """Seed by seed, so that a part of a sweep already compares all team sizes. None twice."""
    starts = starts_of(arguments.starts)
    if starts and len(starts) < max(arguments.robots or [0]):
        raise StartsError(starts_fault("--starts", len(starts), max(arguments.robots)))
    if starts:
        scenario = replace(scenario, starts=starts, robots=arguments.robots or (len(starts),))
    elif arguments.world and not arguments.robots:
        scenario = replace(scenario, robots=_sizes_for(arguments.world, scenario))
    if arguments.odometry:
        scenario = replace(scenario, odometry=arguments.odometry)
    trials = (
        scenario.trial(robots, strategy, seed, arguments.world)
        for seed in range(arguments.seed, arguments.seed + arguments.trials)
        for strategy in arguments.strategy or scenario.strategies
        for robots in arguments.robots or scenario.robots
    )
    return list({trial.key: trial for trial in trials}.values())


def _sizes_for(world: str, scenario: Scenario) -> tuple[int, ...]:
    """Those of the scenario's team sizes for which another world than its own has robots."""
    most = most_robots(scenario.trial(max(scenario.robots), scenario.strategies[0], 0, world))
    sizes = tuple(size for size in scenario.robots if size <= most) or (max(1, most),)
    if most and sizes != scenario.robots:
        told = " and ".join(map(str, sizes))
        print(f"run: {world} has starts for {most}: teams of {told}; give more with --starts", file=sys.stderr)
    return sizes


def main(argv: Sequence[str]) -> int:
    """Runs the sweep; returns the exit code."""
    try:
        with _termination_as_interrupt():
            return _run(make_parser().parse_args(argv))
    except (CallError, TrialError, StartsError) as error:
        print(f"run: {error}", file=sys.stderr)
        return BAD_CALL
    except (ClusterLostError, OSError) as error:
        print(f"run: {error}; the same command goes on from here", file=sys.stderr)
        return LOST
    except KeyboardInterrupt:
        print("run: interrupted; the same command goes on from here", file=sys.stderr)
        return INTERRUPTED


@contextmanager
def _termination_as_interrupt() -> Iterator[None]:
    """So that no trial runs on when a job manager ends the sweep."""

    def interrupt(_: int, __: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _run(arguments: argparse.Namespace) -> int:
    _check_numbers(arguments)
    trials = plan(load_scenario(arguments.scenario), arguments)
    for trial in {(trial.world, trial.robots): trial for trial in trials}.values():
        _check_world(trial)
    for world in dict.fromkeys(trial.world for trial in trials):
        warning = warning_of(world)
        if warning:
            print(f"run: warning: {warning}", file=sys.stderr)
    folder = Path(arguments.out)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise TrialError(f"--out {folder}: {error.strerror}") from None
    left, done = split_done(trials, folder, arguments.retry_failed)
    console = Console(soft_wrap=True, emoji=False, width=None if sys.stdout.isatty() else 120)
    if done:
        console.print(f"{len(done)} of {len(trials)} trials are recorded in {folder} already.", highlight=False)
        _warn_of_other_code(console, done)
    if left:
        done += _run_left(arguments, left, folder, console)
    _print_summary(console, done, folder)
    return 0 if all(entry.status == "finished" for entry in done) else 1


def _check_world(trial: Trial) -> None:
    """A mission in which no robot sees anything is not worth its time. Raises TrialError."""
    if len(truth_for(trial, world_of(trial)).reference) == 0:
        raise TrialError(
            f"{trial.world}: the robots start where nothing can be explored; give --starts inside of its walls"
        )


def _warn_of_other_code(console: Console, done: Sequence[Done]) -> None:
    other = sum(entry.code != code_version() for entry in done)
    if other:
        console.print(
            f"Warning: {other} of them were made by other code or parameters than those here; for records that can be "
            "compared choose another --out.",
            highlight=False,
        )


def _check_numbers(arguments: argparse.Namespace) -> None:
    for name, least in (("trials", 1), ("jobs", 1), ("seed", 0)):
        if getattr(arguments, name) < least:
            raise TrialError(f"--{name} {getattr(arguments, name)} must be at least {least}")
    if arguments.seed + arguments.trials > LARGEST_SEED:
        raise TrialError(f"--seed {arguments.seed}: seeds must be below {LARGEST_SEED}")
    if not arguments.snapshots > 0.0:
        raise TrialError(f"--snapshots {arguments.snapshots:g} must be a positive number of seconds")


def _run_left(arguments: argparse.Namespace, left: list[Trial], folder: Path, console: Console) -> list[Done]:
    if not arguments.scheduler:
        return follow(LocalPool(arguments.jobs, arguments.snapshots), left, folder, console)
    with closing(DaskCluster(arguments.scheduler, arguments.snapshots)) as cluster:
        return follow(cluster, left, folder, console)


def _print_summary(console: Console, done: list[Done], folder: Path) -> None:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for title in ("robots", "strategy", "trials", "finished", "unfinished", "failed", "median time", "mean map error"):
        table.add_column(title, justify="right")
    groups: dict[tuple[int, int], list[Done]] = {}
    for entry in done:
        groups.setdefault((entry.trial.robots, entry.trial.strategy), []).append(entry)
    for (robots, strategy), entries in sorted(groups.items()):
        counts = [sum(entry.status == status for entry in entries) for status in ("finished", "unfinished", "failed")]
        times = [entry.exploration_time for entry in entries if entry.exploration_time is not None]
        errors = [error for entry in entries if entry.status == "finished" for error in entry.map_errors]
        table.add_row(
            str(robots), str(strategy), str(len(entries)), *(str(count) for count in counts),
            f"{statistics.median(times):.1f} s" if times else "-",
            f"{statistics.mean(errors):+.2f} %" if errors else "-",
        )  # fmt: skip
    console.print(table)
    failed = [entry for entry in done if entry.status == "failed"]
    for reason, keys in _by_reason(failed).items():
        console.print(f"{len(keys)} failed, as {keys[0]}: {reason}", highlight=False, markup=False)
    if failed:
        console.print("Failed trials are done again with --retry-failed.", highlight=False)
    if len({entry.code for entry in done}) > 1:
        console.print("Warning: these records were made by different code or parameters.", highlight=False)
    console.print(f"Records in {folder}. Next: rosrun mr_experiments report {quote(str(folder))}", highlight=False)


def _by_reason(failed: Sequence[Done]) -> dict[str, list[str]]:
    """Keys of the trials that failed for each reason."""
    keys: dict[str, list[str]] = {}
    for entry in failed:
        keys.setdefault(entry.reason, []).append(entry.trial.key)
    return keys
