"""How fast missions and the world alone run in virtual time, and how a sweep gains from a second worker. Rows as the
other benchmarks'."""

from __future__ import annotations

import argparse
import json
import math
import statistics
import subprocess
import sys
import time
from contextlib import closing, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Callable, Iterator, Sequence

from mr_experiments.bench.rows import Row, exit_code, printed, row_of, write_rows
from mr_experiments.sweep.dask_cluster import DaskCluster
from mr_experiments.sweep.record import run_trial
from mr_experiments.trial.trial import Trial, TrialError
from mr_measures.record.mission_record import MissionRecord
from mr_sim import bench_world
from mr_sim.world_model import load_world
from mr_sim.worlds import find_world

WORLD, ROBOTS = "office26x15", 3
FULL_BAR, FAST_BAR = 12.0, 100.0  # s of virtual time per s of processor time
SWEEP_BAR = 1.8  # times as fast with two workers as with one
SWEEP_WORLD, SWEEP_ROBOTS, SWEEP_TRIALS, SWEEP_LIMIT = "small8x8", 2, 24, 60.0
START_PATIENCE = 30.0  # s until a Dask cluster is up


def row(what: str, bar: float, value: float | None, unit: str, holds: bool, detail: str) -> Row:
    """Prints and returns a row."""
    return printed(row_of(what, f">= {bar:g}", value, unit, holds, detail))


def shares(cpu: float, by_component: dict[str, float]) -> str:
    """Who used the processor time `cpu` (s), in percent, largest first."""
    parts = sorted(by_component.items(), key=lambda part: -part[1])
    parts.append(("rest", cpu - sum(by_component.values())))
    return ", ".join(f"{name} {100.0 * spent / cpu:.0f} %" for name, spent in parts)


def factor_of(record: MissionRecord) -> float:
    """s of virtual time per s of processor time, over the whole mission with everything that makes its record."""
    return record.outcome.time / (record.measured.cpu or math.nan)


def mission_rows(fast: bool, runs: int, world: str = WORLD, robots: int = ROBOTS) -> list[Row]:
    """The median of whole missions with seeds 1 to `runs`. All must finish."""
    kind = "fast mode" if fast else "SLAM and radio on"
    what, bar = f"mission, {robots} robots, {world}, {kind}", FAST_BAR if fast else FULL_BAR
    unit = "x real time per core"
    try:
        records = [run_trial(Trial(world, robots, seed, fast=fast)) for seed in range(1, runs + 1)]
    except TrialError as error:
        return [row(what, bar, None, unit, False, f"skipped: {error}")]
    factors = [factor_of(record) for record in records]
    finished = sum(record.finished for record in records)
    value = round(statistics.median(factors), 1)
    cpu = sum(record.measured.cpu or 0.0 for record in records)
    components: dict[str, float] = {}
    for record in records:
        for name, spent in record.measured.cpu_by_component.items():
            components[name] = components.get(name, 0.0) + spent
    detail = (
        f"seeds 1 to {runs}, {finished} of {runs} finished, {min(factors):.1f} to {max(factors):.1f}, missions of "
        f"{', '.join(format(record.outcome.time, '.0f') for record in records)} s; {shares(cpu, components)}"
    )
    return [row(what, bar, value, unit, value >= bar and finished == runs, detail)]


def world_rows(seconds: float, runs: int) -> list[Row]:
    """The world alone, `seconds` of virtual time, by the benchmark of mr_sim."""
    measured = bench_world.rows(load_world(find_world(WORLD)), seconds, runs)
    return [row(one.what, one.bar, one.value, one.unit, one.holds, one.detail) for one in measured]


@contextmanager
def dask_cluster(workers: int) -> Iterator[str]:
    """Address of a scheduler on this computer with so many workers of one thread, as people start them. Raises
    TrialError if Dask is missing."""
    processes: list[subprocess.Popen[bytes]] = []
    with TemporaryDirectory() as folder:

        def start(module: str, *options: str) -> None:
            command = [sys.executable, "-m", f"distributed.cli.{module}", "--no-dashboard", *options]
            processes.append(
                subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            )

        try:
            file = Path(folder) / "scheduler.json"
            start("dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file))
            _wait_for(file.exists, processes)
            address = str(json.loads(file.read_text(encoding="utf-8"))["address"])
            for _ in range(workers):
                start("dask_worker", "--nthreads", "1", "--no-nanny", "--memory-limit", "0", address)
            with closing(DaskCluster(address)) as cluster:
                _wait_for(lambda: cluster.threads == workers, processes)
            yield address
        finally:
            for process in reversed(processes):
                process.kill()
                process.wait()


def _wait_for(condition: Callable[[], bool], processes: Sequence[subprocess.Popen[bytes]]) -> None:
    deadline = time.monotonic() + START_PATIENCE
    while not condition():
        if any(process.poll() is not None for process in processes) or time.monotonic() > deadline:
            raise TrialError("no Dask cluster could be started here; is python3-distributed installed?")
        time.sleep(0.1)


def sweep_time(workers: int, trials: Sequence[Trial]) -> float:
    """Wall time of a sweep in s, without the start of the cluster."""
    with dask_cluster(workers) as address, closing(DaskCluster(address)) as cluster, TemporaryDirectory() as folder:
        begun = time.perf_counter()
        done = list(cluster.run(trials, Path(folder)))
        spent = time.perf_counter() - begun
    failed = [entry for entry in done if entry.status == "failed"]
    if failed or len(done) != len(trials):
        raise TrialError(f"the sweep failed: {failed[0].reason if failed else 'trials are missing'}")
    return spent


def sweep_rows(runs: int, trials: int = SWEEP_TRIALS, limit: float = SWEEP_LIMIT) -> list[Row]:
    """One worker and two, one after the other, `runs` times. `limit`: s of virtual time for each trial."""
    what = "sweep over 2 Dask workers of one thread against 1"
    work = [Trial(SWEEP_WORLD, SWEEP_ROBOTS, seed, limit=limit) for seed in range(1, trials + 1)]
    try:
        times = [(sweep_time(1, work), sweep_time(2, work)) for _ in range(runs)]
    except TrialError as error:
        return [row(what, SWEEP_BAR, None, "x", False, f"skipped: {error}")]
    ratios = [one / two for one, two in times]
    value = round(statistics.median(ratios), 2)
    detail = (
        f"{trials} trials of {SWEEP_WORLD} with {SWEEP_ROBOTS} robots to {limit:g} s, median of {runs}: "
        + ", ".join(f"{one:.1f} s / {two:.1f} s = {one / two:.2f}" for one, two in times)
    )
    return [row(what, SWEEP_BAR, value, "x", value >= SWEEP_BAR, detail)]


PARTS: dict[str, Callable[[int], list[Row]]] = {
    "full": lambda runs: mission_rows(False, runs),
    "fast": lambda runs: mission_rows(True, runs),
    "world": lambda runs: world_rows(120.0, runs),
    "sweep": sweep_rows,
}


def main(argv: Sequence[str]) -> int:
    """Prints the rows, writes them if asked; returns 0 when every bar holds, 1 otherwise."""
    parser = argparse.ArgumentParser(prog="bench speed", description="Speed of missions in virtual time.")
    parser.add_argument("--out", type=Path, metavar="FILE", help="JSON file to write the rows to")
    parser.add_argument("--only", nargs="+", choices=list(PARTS), default=list(PARTS), help="parts to run")
    parser.add_argument("--runs", type=int, default=3, metavar="N", help="runs of each (default: %(default)s)")
    arguments = parser.parse_args(argv)
    if arguments.runs < 1:
        parser.error(f"--runs {arguments.runs} must be at least 1")
    rows = [made for part in arguments.only for made in PARTS[part](arguments.runs)]
    if arguments.out:
        write_rows(rows, arguments.out)
    return exit_code(rows)
