#!/usr/bin/env python3
"""Builds the fuzzers with clang and lets them run: run_fuzz.py --seconds 600 --build build/fuzz [TARGET ...]"""

import argparse
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
TARGETS = {"fuzz_wire": 4096, "fuzz_packet_image": 4096, "fuzz_text": 512, "fuzz_engine": 600}  # longest input, octets


class FuzzError(Exception):
    """Nothing could be run, or something was found; the text says what."""


def build(folder):
    """The folder of the executables, built if need be."""
    clang = shutil.which("clang++")
    if clang is None:
        raise FuzzError("the fuzzers need clang++, which is not installed: run tools/install_dependencies fuzz")
    commands = [
        ["cmake", "-S", str(HERE), "-B", str(folder), f"-DCMAKE_CXX_COMPILER={clang}"],
        ["cmake", "--build", str(folder), "--parallel", str(os.cpu_count()), "--target", *TARGETS],
    ]
    for command in commands:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            raise FuzzError(f"the fuzzers cannot be built: {' '.join(command)}\n{done.stdout[-4000:]}")
    return folder


def run(folder, target, seconds):
    """Fuzzes for so long; returns (executions, executions per second). New inputs are kept in the build folder."""
    found = folder / "corpus" / target
    found.mkdir(parents=True, exist_ok=True)
    return fuzz(folder, target, seconds, found)


def fuzz(folder, target, seconds, found):
    command = [
        str(folder / target),
        f"-max_total_time={seconds}",
        f"-max_len={TARGETS[target]}",
        "-entropic=0",  # weighing the inputs by entropy takes three times as long as running them
        "-timeout=20",
        "-rss_limit_mb=2048",
        "-print_final_stats=1",
        f"-artifact_prefix={folder}/{target}-",
        str(found),  # new inputs are written to the first folder
        str(HERE / "corpus" / target),
    ]
    environment = {**os.environ, "ASAN_OPTIONS": "malloc_context_size=4:quarantine_size_mb=16"}
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment)
    if done.returncode != 0:
        what = f"{target} found a fault; the input to give to {folder / target} is named below"
        raise FuzzError(f"{what}\n{done.stdout[-6000:]}")
    statistics = dict(re.findall(r"stat::(\w+): +(\d+)", done.stdout))
    return int(statistics["number_of_executed_units"]), int(statistics["average_exec_per_sec"])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=int, default=600, help="for each target")
    parser.add_argument("--build", type=Path, required=True, help="build folder")
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=" ".join(TARGETS))
    arguments = parser.parse_args()
    unknown = set(arguments.targets) - set(TARGETS)
    if unknown:
        parser.error(f"unknown target {', '.join(sorted(unknown))} (there are {', '.join(TARGETS)})")
    try:
        folder = build(arguments.build.resolve())
        for target in arguments.targets or TARGETS:
            executions, rate = run(folder, target, arguments.seconds)
            print(
                f"{target}: {executions} executions in {arguments.seconds} s, {rate} per second, nothing found",
                flush=True,
            )
    except FuzzError as error:
        print(f"run_fuzz: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
