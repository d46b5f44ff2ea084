"""Navigation where it is hard, ours beside other libraries' planners and navigators on the same scenes."""

import argparse
import statistics
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path

from mr_sim.bench_navigation import CONTACT_BAR, STUCK_BAR, TIME_BAR, tell, write_rows
from mr_sim.bench_world import Row
from mr_sim.nuisance.mrpt_follower import driving_with_mrpt
from mr_sim.nuisance.planners import OURS, ompl, planning_with
from mr_sim.nuisance.runs import SceneRun, run_seed
from mr_sim.nuisance.scenes import KINDS, SceneError

HYBRID, MRPT = "ours", "MRPT PTG"
RADIUS = 0.1  # m of Reeds and Shepp's ways
OMPL_LIMITS = {f"OMPL RRT-Connect {1e3 * limit:.0f} ms": limit for limit in (0.01, 0.05, 0.2)}  # s of a plan
ENGINES = (HYBRID, *OMPL_LIMITS, MRPT)
STEP_BAR = 100.0  # ms of a plan: a command has to come before the next scan


@dataclass(frozen=True)
class EngineRun:
    """`steps`: processor time of each plan of a manoeuvre, or of each step of a navigator that makes none, s."""

    scene: SceneRun
    steps: tuple[float, ...]


def run_with(engine: str, seed: int) -> EngineRun:
    """The scene of a seed."""
    with _in_place(engine) as spent:
        scene = run_seed(seed)
    return EngineRun(scene, tuple(spent))


def _in_place(engine: str) -> AbstractContextManager[list[float]]:
    if engine == MRPT:
        return driving_with_mrpt()
    return planning_with(OURS if engine == HYBRID else ompl(RADIUS, OMPL_LIMITS[engine]))


def rows(results: Mapping[str, Sequence[EngineRun]]) -> list[Row]:
    return [row for engine, runs in results.items() for row in _rows_of(engine, runs)]


def _rows_of(engine: str, runs: Sequence[EngineRun]) -> list[Row]:
    goals = [goal for run in runs for goal in run.scene.goals]
    reached = [goal for goal in goals if goal.reached]
    ratio = sum(goal.seconds for goal in reached) / max(1e-9, sum(goal.ideal for goal in reached))
    contacts = [run.scene.contacts for run in runs]
    steps = [1e3 * step for run in runs for step in run.steps] or [0.0]
    seeds = f"seeds {min(run.scene.seed for run in runs)} to {max(run.scene.seed for run in runs)}"
    return [
        _row("stuck per 100 goals", engine, STUCK_BAR, 100.0 * (1.0 - len(reached) / len(goals)), "",
             f"{len(goals)} goals, {seeds}: {_by_kind(runs)}"),
        _row("steps in contact", engine, CONTACT_BAR, sum(contacts), "", f"in {sum(map(bool, contacts))} scenes"),
        _row("time over the ideal", engine, TIME_BAR, ratio, "x", f"of {len(reached)} goals reached"),
        _row("processor time of a plan", engine, STEP_BAR, statistics.mean(steps), "ms",
             f"mean of {len(steps)}, longest {max(steps):.1f} ms"),
    ]  # fmt: skip


def _row(what: str, engine: str, bar: float, value: float, unit: str, detail: str) -> Row:
    return Row(f"{what}, {engine}", bar, round(value, 2), unit, value <= bar, detail)


def _by_kind(runs: Sequence[EngineRun]) -> str:
    stuck = {kind: sum(run.scene.stuck for run in runs if run.scene.kind == kind) for kind in KINDS}
    return ", ".join(f"{kind} {count}" for kind, count in stuck.items() if count) or "none stuck"


def run_all(engine: str, seeds: Sequence[int], jobs: int) -> Iterator[EngineRun]:
    """In the order of the seeds, in processes of their own."""
    with get_context("fork").Pool(jobs) as pool:
        yield from pool.imap(partial(run_with, engine), seeds)


def main(argv: list[str] | None = None) -> int:
    """Print the table, write the rows if asked; returns 0 when every bar of ours holds."""
    parser = argparse.ArgumentParser(prog="bench_navigation_peers", description="Navigation beside OMPL and MRPT.")
    parser.add_argument("--seeds", type=int, default=200, metavar="N", help="number of scenes (default: %(default)s)")
    parser.add_argument("--first", type=int, default=1, metavar="SEED", help="the first seed (default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processes (default: %(default)s)")
    parser.add_argument("--engines", nargs="+", choices=ENGINES, default=ENGINES, metavar="NAME",
                        help=f"of {', '.join(ENGINES)} (default: all)")  # fmt: skip
    parser.add_argument("--out", help="JSON file to write the rows to")
    arguments = parser.parse_args(argv)
    if arguments.seeds < 1 or arguments.jobs < 1 or arguments.first < 0:
        parser.error("--seeds and --jobs must be at least 1, --first at least 0")
    seeds = range(arguments.first, arguments.first + arguments.seeds)
    results: dict[str, list[EngineRun]] = {}
    try:
        for engine in arguments.engines:
            results[engine] = list(run_all(engine, seeds, arguments.jobs))
            for row in _rows_of(engine, results[engine]):
                tell(row)
    except SceneError as error:
        print(f"bench_navigation_peers: {error}", file=sys.stderr)
        return 1
    except ImportError as error:
        print(f"bench_navigation_peers: `make bench-navigation-peers` builds and runs the others: {error}",
              file=sys.stderr)  # fmt: skip
        return 1
    table = rows(results)
    if arguments.out:
        write_rows(table, Path(arguments.out))
    return 0 if all(row.holds for row in table if row.what.endswith(f", {HYBRID}")) else 1


if __name__ == "__main__":
    sys.exit(main())
