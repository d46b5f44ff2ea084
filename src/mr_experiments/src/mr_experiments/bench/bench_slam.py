"""SLAM on scans and odometry of whole missions, with odometry as recorded and with one whose errors wander."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mr_experiments.bench.real_logs import judge, scan_logs
from mr_experiments.bench.real_logs import measures_of as measures_of_path
from mr_experiments.bench.slam_comparison import (
    OURS,
    Engines,
    Setting,
    comparison_rows,
    measures_of,
    printed,
    table,
)
from mr_experiments.bench.slam_peers import peers
from mr_experiments.common.command_line import BAD_CALL, INTERRUPTED, CallError, Parser
from mr_experiments.host.mission import Mission
from mr_experiments.trial.scenario import load_scenario
from mr_experiments.trial.trial import Trial, TrialError
from mr_grid import Pose
from mr_measures.truth import Truth
from mr_robot.slam.engine import Slam, SlamError
from mr_sim.scan_log import ScanLog, with_random_walk
from mr_sim.slam_evaluation import Engine, Evaluation, evaluate
from mr_sim.true_world import true_world_of
from mr_sim.world import World
from mr_sim.world_model import load_world
from mr_sim.worlds import find_world, label_of

LARGE_LOOPS, LARGE_FLOOR = "large loops", "large floor"
WORLDS = {
    "halls and loops": ("generated:hall:{}:48x20", "generated:loop:{}:45x40"),
    LARGE_LOOPS: ("generated:loop:{}:60x60",),
    LARGE_FLOOR: ("large60x60",),  # slanted walls among square ones, and far ends where the least turn shows
}
"""Of kinds that have not the one of their scenario. Their worlds take turns."""
MOST_LARGE = 6  # missions of the large kinds
ODOMETRY_ERROR = {"pioneers": (0.03, 0.05), "turtlebots": (0.03, 0.01)}
"""Standard deviations of a random walk after 1 m and 1 rad: the bounds of Stage's bias in the worlds. Those of Pioneers
hold for all other kinds."""
WRONG_WALLS = {
    "pioneers": (0.5, 3.0),
    "turtlebots": (3.0, 8.0),
    "halls and loops": (5.0, 5.0),
    LARGE_FLOOR: (0.5, 3.0),
}  # %, mean and worst
KINDS = sorted([*WRONG_WALLS, LARGE_LOOPS])
BIAS, WALK = "a constant bias", "a random walk"
LOOP_END = 0.3  # m, 0.95 quantile of the position's error where large loops end
LIMIT = 900.0  # s of a mission
PER_SCAN = (4.0, 60.0)  # ms, mean and worst


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="bench_slam",
        description="Records scans and odometry of missions of one robot (office with Pioneers and with Turtlebots, "
        "generated halls and loops, loops and a floor of 60 m x 60 m) and runs SLAM over them. Logs that are there are "
        "taken as they are.",
        epilog="Exit code: 0 all bars reached, 1 one is missed, 2 bad options, 130 interrupted.",
    )
    add = parser.add_argument
    add("--first-seed", type=int, default=1, metavar="N", help="of the missions (default: %(default)s)")
    add("--missions", type=int, default=5, metavar="N", help="of each kind (default: %(default)s)")
    add("--kinds", nargs="*", choices=KINDS, default=KINDS, help="none or some (default: all)")
    add("--peers", action="store_true", help="also run MRPT's ICP and RBPF (built by `make bench-slam-peers`)")
    add("--real-logs", metavar="DIR", help="folder of CARMEN logs, to run SLAM over them as well")
    add("--logs", default="out/bench/scans", metavar="DIR", help="folder of the logs (default: %(default)s)")
    add("--out", default="out/bench/slam.json", metavar="FILE", help="rows (default: %(default)s)")
    return parser


def trials(kind: str, first: int, count: int) -> Iterator[Trial]:
    worlds = WORLDS.get(kind, ("",))
    most = MOST_LARGE if kind in (LARGE_LOOPS, LARGE_FLOOR) else count
    for seed in range(first, first + min(count, most)):
        scenario = load_scenario("turtlebot" if kind == "turtlebots" else "paper")
        yield scenario.trial(1, 7, seed, worlds[seed % len(worlds)].format(seed))


def recorded(trial: Trial, folder: Path) -> ScanLog:
    """The log of the trial's first robot, recorded unless it is there."""
    path = folder / f"{label_of(trial.world)}-s{trial.seed}.npz"
    if path.is_file():
        return ScanLog.load(path)
    folder.mkdir(parents=True, exist_ok=True)
    log = record(trial)
    log.save(path)
    return log


def record(trial: Trial) -> ScanLog:
    """Runs the mission."""
    mission = Mission(trial)
    robot, rows = mission.robots[0], []
    handle = robot.on_scan

    def on_scan(ranges: np.ndarray, odometry: Pose) -> tuple[float, float]:
        rows.append((mission.world.time, ranges.copy(), odometry, mission.world.pose(0)))
        return handle(ranges, odometry)

    robot.on_scan = on_scan  # type: ignore[method-assign]
    mission.run(LIMIT)
    description = mission.world.robots[0]
    ranger = description.rangers[description.main_ranger]
    geometry = (ranger.angle_min, ranger.angle_increment, ranger.range_min, ranger.range_max, *ranger.mount)
    times, ranges, odometry, truth = (np.array(column) for column in zip(*rows))
    return ScanLog(trial.world, np.array(geometry), times, ranges.astype(np.float32), odometry, truth)


def truth_of(world: str) -> Truth:
    return Truth.of_world(true_world_of(World(load_world(find_world(world)), 1, 0)))


def rows_of(kind: str, odometry: str, results: Sequence[Evaluation]) -> list[dict[str, Any]]:
    walls = [100.0 * each.wrong_walls for each in results]
    bars, name = WRONG_WALLS[kind], f"{kind}, odometry with {odometry}"
    detail = (
        f"{len(results)} logs; position error mean {np.mean([r.mean_error for r in results]):.3f} m, 0.95 quantile "
        f"{np.mean([r.q95_error for r in results]):.3f} m, at the end {np.mean([r.end_error for r in results]):.3f} m, "
        f"heading {np.degrees(np.mean([r.q95_heading for r in results])):.2f} deg, "
        f"contradicted {100 * np.mean([r.contradicted for r in results]):.1f} %"
    )
    return [
        _row(f"wrong walls, mean, {name}", bars[0], float(np.mean(walls)), "%", detail),
        _row(f"wrong walls, worst, {name}", bars[1], max(walls), "%", ""),
    ]


def _row(what: str, bar: float, value: float, unit: str, detail: str) -> dict[str, Any]:
    holds = value <= bar
    print(f"{'ok  ' if holds else 'MISS'} {what}: {value:.2f} {unit} (bar <= {bar:g}) {detail}", flush=True)
    return {"what": what, "bar": f"<= {bar:g}", "value": value, "unit": unit, "holds": holds, "detail": detail}


def loop_row(results: Sequence[Evaluation]) -> dict[str, Any]:
    """Where the robots come by places that they know from long ago."""
    errors = [each.loop_errors for each in results]
    worst = ", ".join(f"{each.max():.3f}" if len(each) else "no loop" for each in errors)
    together = np.concatenate(errors)
    value = float(np.quantile(together, 0.95)) if len(together) else math.inf
    detail = f"{len(errors)} logs, {len(together)} scans at loop ends, worst of each {worst} m"
    return _row(f"position error at loop ends, 0.95 quantile, {LARGE_LOOPS}, odometry with {WALK}",
                LOOP_END, value, "m", detail)  # fmt: skip


Factories = Mapping[str, Callable[[ScanLog], Engine]]


def judged(logs: Sequence[ScanLog], name: str, make: Callable[[ScanLog], Engine]) -> list[Evaluation]:
    """One engine on logs, a new one for each."""
    results = []
    for log in logs:
        results.append(evaluate(log, truth_of(log.world), make(log)))
        print(f"{label_of(log.world)}, {name}: wrong walls {100 * results[-1].wrong_walls:.1f} %, position error "
              f"{results[-1].q95_error:.3f} m", flush=True)  # fmt: skip
    return results


def run(given: argparse.Namespace) -> list[dict[str, Any]]:
    factories: Factories = {OURS: lambda _: Slam(), **(peers() if given.peers else {})}
    rows: list[dict[str, Any]] = []
    settings: dict[Setting, Engines] = {}
    spent: list[tuple[float, float]] = []
    for kind in given.kinds:
        errors = ODOMETRY_ERROR.get(kind, ODOMETRY_ERROR["pioneers"])
        taken = [(recorded(trial, Path(given.logs)), trial.seed)
                 for trial in trials(kind, given.first_seed, given.missions)]  # fmt: skip
        walks = [with_random_walk(log, *errors, seed) for log, seed in taken]
        if kind == LARGE_LOOPS:
            results = judged(walks, OURS, factories[OURS])
            rows.append(loop_row(results))
            spent += [each.milliseconds for each in results]
            continue
        for odometry, logs in ((BIAS, [log for log, _ in taken]), (WALK, walks)):
            found = {name: judged(logs, name, make) for name, make in factories.items()}
            rows += rows_of(kind, odometry, found[OURS])
            spent += [each.milliseconds for each in found[OURS]]
            settings[kind, odometry] = {name: measures_of(results) for name, results in found.items()}
    if spent:
        rows.append(_row("SLAM per scan, mean", PER_SCAN[0], float(np.mean([mean for mean, _ in spent])), "ms", ""))
        rows.append(_row("SLAM per scan, worst", PER_SCAN[1], max(worst for _, worst in spent), "ms", ""))
    if given.real_logs:
        settings |= real_settings(Path(given.real_logs), given.first_seed, factories)
    return rows + (compared(settings) if given.peers and settings else [])


def real_settings(folder: Path, seed: int, factories: Factories) -> dict[Setting, Engines]:
    """Each log of the folder is a setting of its own."""
    settings: dict[Setting, Engines] = {}
    try:
        logs = list(scan_logs(folder, seed))
    except ValueError as error:
        raise CallError(f"--real-logs: {error}") from None
    for log in logs:
        errors = {name: judge(log, make(log)) for name, make in factories.items()}
        for name, each in errors.items():
            print(f"{log.world}, {name}: position error {each.position:.3f} m, relations {each.relation:.3f} m, "
                  f"{math.degrees(each.turn):.2f} deg", flush=True)  # fmt: skip
        settings[log.world, WALK] = {name: measures_of_path(each) for name, each in errors.items()}
    return settings


def compared(settings: Mapping[Setting, Engines]) -> list[dict[str, Any]]:
    print(table(settings), flush=True)
    return [printed(row) for row in comparison_rows(settings)]


def main(arguments: Sequence[str]) -> int:
    """Writes the rows; returns the exit code."""
    try:
        given = make_parser().parse_args(arguments)
        if given.missions < 1:
            raise CallError(f"--missions must be at least 1, not {given.missions}")
        rows = run(given)
        Path(given.out).parent.mkdir(parents=True, exist_ok=True)
        Path(given.out).write_text(json.dumps(rows, indent=1) + "\n")
    except (CallError, TrialError, SlamError, OSError) as error:
        print(f"bench_slam: {error}", file=sys.stderr)
        return BAD_CALL
    except KeyboardInterrupt:
        print("bench_slam: interrupted", file=sys.stderr)
        return INTERRUPTED
    return 0 if all(row["holds"] for row in rows) else 1
