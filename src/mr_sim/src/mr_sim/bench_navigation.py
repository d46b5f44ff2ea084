"""How often robots get stuck where navigation is hard: scenes drawn from seeds. Rows as the other benchmarks'."""

import argparse
import json
import statistics
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path

from mr_sim.bench_world import Row
from mr_sim.nuisance.runs import PIONEER, SceneRun, run_seed
from mr_sim.nuisance.scenes import KINDS, SceneError
from mr_sim.worlds import WorldNotFoundError

STUCK_BAR, CONTACT_BAR = 1.0, 0.0
TIME_BAR = 3.0  # times the ideal
COMMAND_BAR, WORST_BAR = 2.0, 100.0  # ms; a command has to come before the next scan


def rows(runs: Sequence[SceneRun], robot: str = PIONEER) -> list[Row]:
    """Of all scenes, and how often robots got stuck in those of each kind. `robot`: kind of the robots, or their file,
    which rows of others than Pioneers name."""
    seeds = f"seeds {min(run.seed for run in runs)} to {max(run.seed for run in runs)}"
    goals = [goal for run in runs for goal in run.goals]
    reached = [goal for goal in goals if goal.reached]
    stuck = 100.0 * (1.0 - len(reached) / len(goals))
    contacts = sum(run.contacts for run in runs)
    ratio = sum(goal.seconds for goal in reached) / max(1e-9, sum(goal.ideal for goal in reached))
    commands = sum(run.commands for run in runs)
    spent = 1e3 * sum(run.navigation for run in runs) / commands
    worst = 1e3 * max(run.slowest for run in runs)
    touching = [str(run.seed) for run in runs if run.contacts]
    table = [
        _row("stuck per 100 goals", STUCK_BAR, stuck, "", f"{len(goals)} goals, {seeds}: {_by_kind(runs)}"),
        _row("steps in contact", CONTACT_BAR, contacts, "", f"in the scenes {', '.join(touching) or 'none'}"),
        _row("time over the ideal", TIME_BAR, ratio, "x", f"of {len(reached)} goals reached"),
        _row("processor time of a command", COMMAND_BAR, spent, "ms", f"mean of {commands}, with maps"),
        _row("longest command", WORST_BAR, worst, "ms", "median of the scenes' longest "
             f"{1e3 * statistics.median(run.slowest for run in runs):.1f} ms"),
    ]  # fmt: skip
    return table if robot == PIONEER else [replace(row, what=f"{Path(robot).stem}: {row.what}") for row in table]


def _by_kind(runs: Sequence[SceneRun]) -> str:
    parts = []
    for kind in KINDS:
        of_kind = [run for run in runs if run.kind == kind]
        if of_kind:
            parts.append(f"{kind} {sum(run.stuck for run in of_kind)} of {sum(len(run.goals) for run in of_kind)}")
    return ", ".join(parts)


def _row(what: str, bar: float, value: float, unit: str, detail: str) -> Row:
    return Row(what=what, bar=bar, value=round(value, 2), unit=unit, holds=value <= bar, detail=detail)


def tell(row: Row) -> None:
    """A line of the terminal; every bar here is an upper one."""
    verdict = "ok  " if row.holds else "MISS"
    print(f"{verdict} {row.what}: {row.value:g} {row.unit} (bar <= {row.bar:g}) {row.detail}", flush=True)


def write_rows(table: Sequence[Row], path: Path) -> None:
    """As JSON, as the other benchmarks'."""
    path.parent.mkdir(parents=True, exist_ok=True)
    written = [{**asdict(row), "bar": f"<= {row.bar:g}"} for row in table]
    path.write_text(json.dumps(written, indent=1) + "\n", encoding="utf-8")


def run_all(seeds: Sequence[int], jobs: int, robot: str = PIONEER) -> Iterator[SceneRun]:
    """In the order of the seeds."""
    run = partial(run_seed, kind=robot)
    if jobs == 1:
        yield from map(run, seeds)
        return
    with get_context("fork").Pool(jobs) as pool:
        yield from pool.imap(run, seeds)


def _report(run: SceneRun) -> None:
    """Prints what went wrong."""
    for goal in run.goals:
        if not goal.reached:
            where = f"({goal.goal[0]:.2f}, {goal.goal[1]:.2f})"
            why = goal.why or f"not reached in {goal.seconds:.0f} s"
            print(f"    scene {run.seed}, {run.kind}: robot {goal.robot} to {where}: {why}", flush=True)
    if run.contacts:
        print(f"    scene {run.seed}, {run.kind}: {run.contacts} steps in contact", flush=True)


def main(argv: list[str] | None = None) -> int:
    """Print the table, write the rows if asked; returns 0 when every bar holds."""
    parser = argparse.ArgumentParser(prog="bench_navigation", description="Navigation where it is hard.")
    parser.add_argument("--seeds", type=int, default=200, metavar="N", help="number of scenes (default: %(default)s)")
    parser.add_argument("--first", type=int, default=1, metavar="SEED", help="the first seed (default: %(default)s)")
    parser.add_argument(
        "--robot", default=PIONEER, metavar="KIND|FILE.inc",
        help="pioneer, turtlebot, or the file of a model; a larger one has wider doors (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processes (default: %(default)s)")
    parser.add_argument("--out", help="JSON file to write the rows to")
    arguments = parser.parse_args(argv)
    if arguments.seeds < 1 or arguments.jobs < 1 or arguments.first < 0:
        parser.error("--seeds and --jobs must be at least 1, --first at least 0")
    runs = []
    try:
        for run in run_all(range(arguments.first, arguments.first + arguments.seeds), arguments.jobs, arguments.robot):
            _report(run)
            runs.append(run)
    except (SceneError, WorldNotFoundError) as error:
        print(f"bench_navigation: {error}", file=sys.stderr)
        return 1
    table = rows(runs, arguments.robot)
    for row in table:
        tell(row)
    if arguments.out:
        write_rows(table, Path(arguments.out))
    return 0 if all(row.holds for row in table) else 1


if __name__ == "__main__":
    sys.exit(main())
