"""Benchmark of teams of whole agents: wrong transforms that a robot believes, and how soon they are gone. Prints a
table and writes rows {what, bar, value, unit, holds, detail} as JSON."""

import argparse
import json
import os
import sys

import cv2

from map_merger.benchmark import injection


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
    for each in rows:
        print(f"{'ok ' if each['holds'] else 'NO '} {each['what']}: {each['value']} {each['unit']} ({each['bar']})")
    os.makedirs(os.path.dirname(options.out) or ".", exist_ok=True)
    with open(options.out, "w", encoding="utf-8") as file:
        json.dump(rows, file, indent=1)
        file.write("\n")
    print(f"{sum(each['holds'] for each in rows)} of {len(rows)} bars hold; rows in {options.out}")
    return 0 if all(each["holds"] for each in rows) else 1
