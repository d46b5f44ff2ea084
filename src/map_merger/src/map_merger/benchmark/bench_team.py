"""Benchmark of teams of whole agents: wrong transforms that a robot believes, and how soon they are gone. Prints a
table and writes rows {what, bar, value, unit, holds, detail} as JSON."""

import argparse
import sys

import cv2

from map_merger.benchmark import injection
from map_merger.benchmark.rows import conclude


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--teams", type=int, default=20, help="teams of four, and of two (default 20)")
    parser.add_argument("--seed", type=int, default=5000, help="first seed (default 5000)")
    parser.add_argument(
        "--out", default="out/bench/team.json", help="where to write the rows (default out/bench/team.json)"
    )
    return parser.parse_args()


def measured(options: argparse.Namespace, robots: int) -> list:
    results = []
    for seed in range(options.seed, options.seed + options.teams):
        results.append(injection.inject(seed, robots=robots))
        print(f"  {robots} robots, {results[-1]}", flush=True)
    return results


def main() -> int:
    options = arguments()
    cv2.setNumThreads(1)
    command = "bench_team " + " ".join(sys.argv[1:])
    rows = injection.rows_of(measured(options, injection.ROBOTS), measured(options, 2), command.strip())
    return conclude(rows, options.out)
