"""SLAM on scans and odometry of whole missions, with odometry as recorded and with one whose errors wander."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from mr_experiments.bench import slam_carried
from mr_experiments.bench.real_logs import PathErrors, judge, scan_logs
from mr_experiments.bench.real_logs import measures_of as measures_of_path
from mr_experiments.bench.rows import Row, exit_code, printed, row_of, write_rows
from mr_experiments.bench.slam_comparison import (
    OURS,
    Engines,
    Setting,
    comparison_rows,
    measures_of,
    table,
)
from mr_experiments.bench.slam_logs import FIRST_SEED, KINDS, Kind, drives, results_of, slam_of, truth_of, within_bounds
from mr_experiments.bench.slam_peers import peers
from mr_experiments.common.bounded import NoResult
from mr_experiments.common.command_line import BAD_CALL, INTERRUPTED, CallError, Parser
from mr_experiments.trial.trial import TrialError
from mr_robot.platforms.engines import defaults_of
from mr_robot.slam.engine import Slam, SlamError
from mr_robot.slam.options import SlamOptions
from mr_sim.scan_log import ScanLog
from mr_sim.slam_evaluation import Engine, Evaluation, evaluate

BIAS, WALK = "a constant bias", "a random walk"
LOOP_END = 0.3  # m, 0.95 quantile of the position's error where large loops end
PER_SCAN = (4.0, 60.0)  # ms, mean and worst
NO_RESULT = Evaluation(math.inf, math.inf, math.inf, np.empty(0), math.inf, math.inf, 0.0, 1.0, (math.inf, math.inf))
NO_PATH = PathErrors(math.inf, math.inf, math.inf, (math.inf, math.inf))

Make = Callable[[ScanLog], Engine]


@dataclass(frozen=True)
class Spent:
    """Processor time of SLAM on one log. `mean`, `worst`: ms per scan."""

    kind: str
    scans: int
    mean: float
    worst: float


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="bench slam",
        description="Records scans and odometry of missions of one robot ("
        + ", ".join(f"{kind.logs} of {name}" for name, kind in KINDS.items())
        + ") and runs SLAM over them, each with the options of its robot; those of "
        + " and ".join(name for name, kind in KINDS.items() if kind.found is not None)
        + f" once more with robots that are carried {slam_carried.WAY:g} m away, after {100 * slam_carried.KNOWN:g} % "
        "of their scans. Logs that are there are taken as they are.",
        epilog="Exit code: 0 all bars reached, 1 one is missed, 2 bad options, 130 interrupted.",
    )
    add = parser.add_argument
    add("--first-seed", type=int, default=FIRST_SEED, metavar="N", help="of the missions (default: %(default)s)")
    add("--missions", type=int, metavar="N", help="no more than the first N of each kind (default: all)")
    add("--kinds", nargs="*", choices=list(KINDS), default=list(KINDS), help="none or some (default: all)")
    add("--peers", action="store_true", help="instead compare with MRPT's ICP and RBPF, which `make bench-slam-peers` "
        "builds, on the kinds that are not judged by their loops")  # fmt: skip
    add("--real-logs", metavar="DIR", help="folder of CARMEN logs, to run SLAM over them as well")
    add("--logs", default="out/bench/scans", metavar="DIR", help="folder of the logs (default: %(default)s)")
    add("--out", default="out/bench/slam.json", metavar="FILE", help="rows (default: %(default)s)")
    return parser


def rows_of(name: str, bars: tuple[float, float], odometry: str, results: Sequence[Evaluation]) -> list[Row]:
    walls = [100.0 * each.wrong_walls for each in results]
    detail = (
        f"{len(results)} logs; position error mean {np.mean([r.mean_error for r in results]):.3f} m, 0.95 quantile "
        f"{np.mean([r.q95_error for r in results]):.3f} m, at the end {np.mean([r.end_error for r in results]):.3f} m, "
        f"heading {np.degrees(np.mean([r.q95_heading for r in results])):.2f} deg, "
        f"contradicted {100 * np.mean([r.contradicted for r in results]):.1f} %"
    )
    above = f"{sum(share > bars[1] for share in walls)} of {len(walls)} logs above"
    return [
        _row(f"wrong walls, mean, {name}, odometry with {odometry}", bars[0], float(np.mean(walls)), "%", detail),
        _row(f"wrong walls, worst, {name}, odometry with {odometry}", bars[1], max(walls), "%", above),
    ]


def _row(what: str, bar: float, value: float, unit: str, detail: str) -> Row:
    return printed(row_of(what, f"<= {bar:g}", value, unit, value <= bar, detail))


def loop_row(name: str, results: Sequence[Evaluation]) -> Row:
    """Where the robots come by places that they know from long ago: over the scans of all logs together. A log whose
    mission closed no loop has no such scan."""
    errors = [each.loop_errors for each in results]
    own = [float(np.quantile(each, 0.95)) for each in errors if len(each)]
    together = np.concatenate(errors)
    value = float(np.quantile(together, 0.95)) if len(together) else math.inf
    each = ", ".join(f"{np.quantile(one, 0.95):.3f}" if len(one) else "no loop" for one in errors)
    detail = (
        f"{len(together)} scans at loop ends; {len(errors)} logs, {len(errors) - len(own)} of them without a loop; "
        f"{sum(one > LOOP_END for one in own)} of {len(own)} above {LOOP_END:g} m by themselves; "
        f"0.95 quantile of each: {each} m"
    )
    return _row(f"position error at loop ends, 0.95 quantile, {name}, odometry with {WALK}",
                LOOP_END, value, "m", detail)  # fmt: skip


def time_rows(spent: Sequence[Spent]) -> list[Row]:
    """Over the scans of all logs, and for each kind, slowest first."""
    kinds = {kind: [each for each in spent if each.kind == kind] for kind in dict.fromkeys(each.kind for each in spent)}
    means = {kind: _mean(of_kind) for kind, of_kind in kinds.items()}
    worst = {kind: max(each.worst for each in of_kind) for kind, of_kind in kinds.items()}
    scans = f"{sum(each.scans for each in spent)} scans, one core; "
    return [
        _row("SLAM per scan, mean", PER_SCAN[0], _mean(spent), "ms", scans + _slowest_first(means)),
        _row("SLAM per scan, worst", PER_SCAN[1], max(worst.values()), "ms", _slowest_first(worst)),
    ]


def _mean(spent: Sequence[Spent]) -> float:
    return sum(each.scans * each.mean for each in spent) / sum(each.scans for each in spent)


def _slowest_first(by_kind: Mapping[str, float]) -> str:
    return ", ".join(f"{kind} {value:.1f}" for kind, value in sorted(by_kind.items(), key=lambda each: -each[1]))


@dataclass
class Judged:
    """What became of one engine on logs. `results` of those on which it ended, with their numbers of `scans`; `failed`:
    the others, in words."""

    results: list[Evaluation] = field(default_factory=list)
    scans: list[int] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)

    @property
    def with_lost(self) -> list[Evaluation]:
        """A log on which an engine does not end counts as infinitely wrong."""
        return self.results + [NO_RESULT] * len(self.failed)


def judged(logs: Mapping[str, ScanLog], name: str, make: Make) -> Judged:
    """One engine on logs by name, a new one for each, in a process of its own."""
    found = Judged()
    for called, result in results_of(logs, name, lambda log: evaluate(log, truth_of(log), make(log)), found.failed):
        found.results.append(result)
        found.scans.append(len(logs[called].times))
        print(f"{called}, {name}: wrong walls {100 * result.wrong_walls:.1f} %, position error "
              f"{result.q95_error:.3f} m", flush=True)  # fmt: skip
    return found


def failed_row(failed: Sequence[str]) -> Row:
    """Logs on which our SLAM did not end, or which could not be recorded: no other row counts them."""
    return _row("logs without a result", 0.0, float(len(failed)), "logs", "; ".join(failed) or "each has one")


def own_rows(given: argparse.Namespace) -> list[Row]:
    rows: list[Row] = []
    spent: list[Spent] = []
    failed: list[str] = []
    for name in given.kinds:
        settings, lost = _logs(KINDS[name], given)
        failed += lost
        for odometry, logs in settings:
            found = judged(logs, OURS, slam_of)
            failed += [f"odometry with {odometry}, {each}" for each in found.failed]
            if found.results:
                rows += rows_of(name, KINDS[name].walls, odometry, found.results)
                rows += [loop_row(name, found.results)] if KINDS[name].loops else []
            spent += [Spent(name, scans, *each.milliseconds) for scans, each in zip(found.scans, found.results)]
        if KINDS[name].found is not None:
            carried = slam_carried.recoveries(dict(settings)[WALK], slam_of)
            failed += carried.failed
            if carried.found:
                rows += slam_carried.rows_of(f"{name}, odometry with {WALK}", KINDS[name], carried.found)
            spent += [Spent(f"{name}, carried", scans, *each.milliseconds)
                      for scans, each in zip(carried.scans, carried.found)]  # fmt: skip
    if given.real_logs:
        _, lost = real_settings(Path(given.real_logs), given.first_seed, {OURS: undescribed})
        failed += lost
    return [*rows, *(time_rows(spent) if spent else []), failed_row(failed)]


def _logs(kind: Kind, given: argparse.Namespace) -> tuple[list[tuple[str, dict[str, ScanLog]]], list[str]]:
    """By name, with each model of odometry that the kind is judged with; and those that could not be recorded, in
    words."""
    taken, failed = drives(kind, given.first_seed, given.missions, Path(given.logs))
    walking = (WALK, {drive.name: drive.walking for drive in taken})
    return [walking] if kind.loops else [(BIAS, {drive.name: drive.biased for drive in taken}), walking], failed


def peer_rows(given: argparse.Namespace) -> list[Row]:
    others = peers()
    engines: dict[str, Make] = {OURS: slam_of, **others}
    settings: dict[Setting, Engines] = {}
    failed: list[str] = []
    for name in given.kinds:
        if KINDS[name].loops:
            continue
        taken, lost = _logs(KINDS[name], given)
        failed += lost
        for odometry, logs in taken:
            found = {each: judged(logs, each, make) for each, make in engines.items()} if logs else {}
            if found:
                failed += [f"odometry with {odometry}, {each}" for each in found[OURS].failed]
                settings[name, odometry] = {each: measures_of(one.with_lost) for each, one in found.items()}
    if given.real_logs:
        real, lost = real_settings(Path(given.real_logs), given.first_seed, {OURS: undescribed, **others})
        settings, failed = settings | real, failed + lost
    return (compared(settings) if settings else []) + ([failed_row(failed)] if failed else [])


def undescribed(_: ScanLog) -> Slam:
    """Of a robot that nobody has described: what the node takes then."""
    return Slam(SlamOptions(**defaults_of(SlamOptions)))


def real_settings(folder: Path, seed: int, engines: Mapping[str, Make]) -> tuple[dict[Setting, Engines], list[str]]:
    """Each log of the folder is a setting of its own; and on which logs ours did not end, in words."""
    settings: dict[Setting, Engines] = {}
    failed: list[str] = []
    try:
        logs = list(scan_logs(folder, seed))
    except ValueError as error:
        raise CallError(f"--real-logs: {error}") from None
    for log in logs:
        errors: dict[str, PathErrors] = {}
        for name, make in engines.items():
            try:
                each = within_bounds(log, _judging(make))
            except NoResult as error:
                each = NO_PATH
                failed += [f"{log.world}, {name}: {error}"] if name == OURS else []
                print(f"FAILED {log.world}, {name}: {error}", flush=True)
            else:
                print(f"{log.world}, {name}: position error {each.position:.3f} m, relations {each.relation:.3f} m, "
                      f"{math.degrees(each.turn):.2f} deg", flush=True)  # fmt: skip
            errors[name] = each
        settings[log.world, WALK] = {name: measures_of_path(each) for name, each in errors.items()}
    return settings, failed


def _judging(make: Make) -> Callable[[ScanLog], PathErrors]:
    return lambda log: judge(log, make(log))


def compared(settings: Mapping[Setting, Engines]) -> list[dict[str, Any]]:
    print(table(settings), flush=True)
    return [printed(row) for row in comparison_rows(settings)]


def main(arguments: Sequence[str]) -> int:
    """Writes the rows; returns the exit code."""
    try:
        given = make_parser().parse_args(arguments)
        if given.missions is not None and given.missions < 1:
            raise CallError(f"--missions must be at least 1, not {given.missions}")
        rows = peer_rows(given) if given.peers else own_rows(given)
        write_rows(rows, Path(given.out))
    except (CallError, TrialError, SlamError, OSError) as error:
        print(f"bench slam: {error}", file=sys.stderr)
        return BAD_CALL
    except KeyboardInterrupt:
        print("bench slam: interrupted", file=sys.stderr)
        return INTERRUPTED
    return exit_code(rows)
