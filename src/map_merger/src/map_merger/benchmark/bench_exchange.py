"""Benchmark of the exchange of maps: prints a table and writes rows {what, bar, value, unit, holds, detail} as JSON."""

import argparse
import sys

import numpy as np

from map_merger import exchange_benchmark as benchmark
from map_merger.benchmark.rows import conclude
from map_merger.synthetic import FloorPlan, Survey, Surveyor, office_plan, plan_from_image

LOSS = 0.3
SPEED = 0.3
"""m/s of the imaginary robot, stops and turns included."""
RECONNECTED_S, SHARE = 10.0, 10.0


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20, help="runs of the scenario (default 20)")
    parser.add_argument("--seed", type=int, default=2001, help="first seed (default 2001)")
    parser.add_argument("--floor-plan", metavar="IMAGE", help="measure bytes on this floor plan as well")
    parser.add_argument(
        "--resolution", type=float, default=0.05, help="metres per pixel of the floor plan (default 0.05)"
    )
    parser.add_argument("--minutes", type=float, default=6.0, help="length of a survey (default 6)")
    parser.add_argument("--surveys", type=int, default=3, help="surveys per floor (default 3)")
    parser.add_argument(
        "--out", default="out/bench/exchange.json", help="where to write the rows (default out/bench/exchange.json)"
    )
    return parser.parse_args()


def row(what: str, bar: str, value: float, unit: str, holds: bool, detail: str) -> dict:
    command = "bench_exchange " + " ".join(sys.argv[1:])
    return {"what": what, "bar": bar, "value": value, "unit": unit, "holds": holds, "detail": f"{detail}; {command}"}


def repair_rows(options: argparse.Namespace) -> list:
    """How fast the maps become equal again."""
    seeds = range(options.seed, options.seed + options.seeds)
    outcomes = [benchmark.reconnect(seed, loss=LOSS) for seed in seeds]
    times = [float("inf") if outcome.seconds is None else outcome.seconds for outcome in outcomes]
    within = sum(time <= RECONNECTED_S for time in times)
    for outcome in outcomes:
        print(f"  seed {outcome.seed}: {outcome.seconds} s, {outcome.requests} requests")
    detail = (
        f"{within} of {len(times)} within {RECONNECTED_S:g} s, median {np.median(times):.1f} s; 4 robots, "
        f"{LOSS:.0%} of the messages lost per receiver before, during and after, two restarts, partition of 60 s, the "
        f"radio announces the others {benchmark.NOTICED_S:g} s after its end; "
        f"maps equal cell by cell; seeds {seeds[0]}..{seeds[-1]}"
    )
    what = "maps equal everywhere after loss, restart and partition, slowest"
    return [row(what, f"<= {RECONNECTED_S:g}", max(times), "s", within == len(times), detail)]


def traffic_rows(options: argparse.Namespace, name: str, plans: list, split_size: int) -> list:
    """What the changes weigh against whole maps."""
    count = round(options.minutes * 60.0 / benchmark.PERIOD_S)
    survey = Survey(
        path_length=SPEED * 60.0 * options.minutes,
        step=0.15,
        stages=tuple((index + 1) / count for index in range(count)),
    )
    figures = []
    for number, plan in enumerate(plans):
        random = np.random.default_rng(options.seed + number)
        figures.append(benchmark.traffic(Surveyor(plan).explore(random, survey).stages, split_size))
    shares = [100.0 * figure.changes / figure.whole for figure in figures]
    share = 100.0 * sum(figure.changes for figure in figures) / sum(figure.whole for figure in figures)
    minutes = sum(figure.minutes for figure in figures)
    detail = (
        f"{sum(figure.changes for figure in figures) / minutes / 1000.0:.1f} against "
        f"{sum(figure.whole for figure in figures) / minutes / 1000.0:.1f} kB per robot and minute, surveys "
        f"{min(shares):.1f} to {max(shares):.1f} %; {len(plans)} surveys of {options.minutes:g} min at {SPEED:g} m/s, "
        f"sent every {benchmark.PERIOD_S:g} s, split_size {split_size}; both compressed with zstd level "
        f"{benchmark.ZSTD_LEVEL} as the radio does it; {parts_of(figures)}; seeds from {options.seed}"
    )
    what = f"bytes of changes against whole maps: {name}, split_size {split_size}"
    return [row(what, f"<= {SHARE:g}", round(share, 1), "%", share <= SHARE, detail)]


def parts_of(figures: list) -> str:
    """The share of each kind of message in the changes."""
    total = sum(figure.changes for figure in figures)
    kinds = sorted({kind for figure in figures for kind in figure.parts})
    shares = (100.0 * sum(figure.parts.get(kind, 0) for figure in figures) / total for kind in kinds)
    return "of it " + ", ".join(f"{kind} {share:.0f} %" for kind, share in zip(kinds, shares))


def offices(options: argparse.Namespace, rooms: int) -> list:
    seeds = range(options.seed, options.seed + options.surveys)
    return [office_plan(np.random.default_rng(seed), rooms) for seed in seeds]


def image_plans(options: argparse.Namespace) -> "list[FloorPlan]":
    return [plan_from_image(options.floor_plan, options.resolution)] * options.surveys


def main() -> int:
    options = arguments()
    rows = repair_rows(options)
    rows += traffic_rows(options, "office of 6 x 2 rooms", offices(options, 6), 2048)
    rows += traffic_rows(options, "office of 20 x 2 rooms", offices(options, 20), 2048)
    if options.floor_plan:
        rows += traffic_rows(options, "given floor plan", image_plans(options), 2048)
    return conclude(rows, options.out)
