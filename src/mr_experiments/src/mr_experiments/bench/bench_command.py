"""Command line of ``rosrun mr_experiments bench``."""

from __future__ import annotations

import importlib
import sys
from difflib import get_close_matches
from typing import NamedTuple, Sequence

from mr_experiments.common.command_line import BAD_CALL


class Benchmark(NamedTuple):
    """A benchmark and what it measures."""

    module: str
    about: str


BENCHMARKS = {
    "buildings": Benchmark("bench_buildings_command", "missions in other buildings, with other robots and teams"),
    "decisions": Benchmark("bench_decisions", "how long an explorer takes to decide on a large map"),
    "explore": Benchmark("bench_explore_command", "what more robots bring on floors that nothing was tuned on"),
    "hardship": Benchmark("bench_hardship_command", "missions with a bad radio, a robot that dies, a partition"),
    "merging": Benchmark("bench_merging_command", "how soon teams know where their members are"),
    "slam": Benchmark("bench_slam", "SLAM on recorded scans, beside the truth or other SLAM"),
    "speed": Benchmark("bench_speed", "how much faster than real time missions run"),
}

USAGE = "usage: bench BENCHMARK [option ...]"


def help_text() -> str:
    """All benchmarks, one a line."""
    lines = [f"  {name:12}{benchmark.about}" for name, benchmark in BENCHMARKS.items()]
    return "\n".join(
        [
            USAGE,
            "",
            "Measures one thing; prints a row for each bar and writes the rows as JSON (--out).",
            "",
            "benchmarks:",
            *lines,
            "",
            "bench BENCHMARK --help lists the options of one.",
        ]
    )


def main(arguments: Sequence[str]) -> int:
    """Runs the benchmark that is named first with the options behind it; returns its exit code."""
    name = arguments[0] if arguments else ""
    if name in ("-h", "--help"):
        print(help_text())
        return 0
    if name not in BENCHMARKS:
        print(f"bench: {_refusal(name)}", file=sys.stderr)
        return BAD_CALL
    # Only what is asked for is imported: some need a second for their libraries.
    module = importlib.import_module(f"mr_experiments.bench.{BENCHMARKS[name].module}")
    code: int = module.main(arguments[1:])
    return code


def _refusal(name: str) -> str:
    if not name:
        return "which benchmark? (--help lists them)"
    near = get_close_matches(name, BENCHMARKS, n=1)
    return f"there is no benchmark {name}" + (f"; is {near[0]} meant?" if near else " (--help lists them)")
