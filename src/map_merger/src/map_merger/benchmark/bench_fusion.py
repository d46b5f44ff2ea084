"""Benchmark of the global map: time of an update after one tile, memory, and the quality of merged maps of synthetic
teams. Prints a table and writes rows {what, bar, value, unit, holds, detail} as JSON."""

import argparse
import sys

import cv2

from map_merger import fusion_benchmark
from map_merger.benchmark.rows import conclude


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=8, help="robots of the timed team (default 8)")
    parser.add_argument("--edge", type=int, default=2000, help="edge in cells of their maps (default 2000)")
    parser.add_argument("--updates", type=int, default=40, help="timed updates (default 40)")
    parser.add_argument("--teams", type=int, default=10, help="synthetic teams of four for the quality (default 10)")
    parser.add_argument("--seed", type=int, default=3000, help="first seed (default 3000)")
    parser.add_argument(
        "--out", default="out/bench/fusion.json", help="where to write the rows (default out/bench/fusion.json)"
    )
    return parser.parse_args()


def main() -> int:
    options = arguments()
    cv2.setNumThreads(1)
    command = "bench_fusion " + " ".join(sys.argv[1:])
    rows = fusion_benchmark.timing_rows(options.robots, options.edge, options.updates, options.seed, command)
    rows += fusion_benchmark.quality_rows(options.teams, options.seed, command)
    return conclude(rows, options.out)
