#!/usr/bin/env python3
"""Builds the fuzzers with clang and lets them run: run_fuzz.py --seconds 600 --build build/fuzz [TARGET ...]

Each run that ends adds a line to runs.csv, beside this file: what all runs together have seen is a row of the results.
With --merge the inputs learned so far that reach what the stored ones do not are stored, too.
"""

import argparse
import csv
import datetime
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
LEDGER = HERE / "runs.csv"
COLUMNS = ("date", "target", "sources", "seconds", "inputs", "found")
WANTED = 100_000_000  # inputs, of all targets together
TARGETS = {  # longest input, octets
    "fuzz_wire": 4096,
    "fuzz_packet_image": 4096,
    "fuzz_text": 512,
    "fuzz_engine": 600,
    "fuzz_sealed": 600,
    "fuzz_message": 2048,
    "fuzz_payload": 1024,
}


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


def learned(folder, target):
    """Where the inputs go that the fuzzer finds worth keeping."""
    found = folder / "corpus" / target
    found.mkdir(parents=True, exist_ok=True)
    return found


def run(folder, target, seconds, ledger=LEDGER):
    """Fuzzes for so long; returns (executions, executions per second). New inputs are kept in the build folder. The run
    is entered into the ledger, also one that finds a fault, which raises FuzzError."""
    output, fault = fuzz(folder, target, seconds)
    statistics = dict(re.findall(r"stat::(\w+): +(\d+)", output))
    if "number_of_executed_units" in statistics:
        inputs = int(statistics["number_of_executed_units"])
        enter(ledger, target, seconds, inputs, fault)
    if fault:
        what = f"{target} found a fault; the input to give to {folder / target} is named below"
        raise FuzzError(f"{what}\n{output[-6000:]}")
    return inputs, int(statistics["average_exec_per_sec"])


def enter(ledger, target, seconds, inputs, fault):
    new = not ledger.exists()
    with ledger.open("a", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        if new:
            writer.writerow(COLUMNS)
        today = datetime.datetime.now(datetime.timezone.utc).date()
        writer.writerow((today, target, sources(), seconds, inputs, "a fault" if fault else "nothing"))


def sources():
    """What was fuzzed: a hash of the package's sources and of the fuzzers."""
    package = HERE.parent.parent
    files = [path for root in (package / "src", package / "include", HERE) for path in root.rglob("*.?pp")]
    total = hashlib.sha256()
    for path in sorted(files):
        total.update(str(path.relative_to(package)).encode() + b"\0" + path.read_bytes())
    return total.hexdigest()[:12]


def row(ledger=LEDGER):
    """All runs so far, as the row of a benchmark."""
    with ledger.open(newline="", encoding="utf-8") as file:
        runs = list(csv.DictReader(file))
    of = {target: sum(int(run["inputs"]) for run in runs if run["target"] == target) for target in TARGETS}
    faults = sum(run["found"] != "nothing" for run in runs)
    return {
        "what": "inputs that the fuzzers have seen in all runs together",
        "bar": f">= {WANTED:.0e}",
        "value": sum(of.values()),
        "unit": "inputs",
        "holds": sum(of.values()) >= WANTED,
        "detail": f"{len(runs)} runs, {faults} of which found a fault; "
        + ", ".join(f"{target} {inputs}" for target, inputs in of.items()),
    }


def merge(folder, target):
    """Stores few inputs that reach all code that those learned reach and the stored ones do not; returns how many."""
    corpus = HERE / "corpus" / target
    before = len(list(corpus.iterdir()))
    options = ["-set_cover_merge=1", "-use_counters=0", f"-max_len={TARGETS[target]}"]
    command = [str(folder / target), *options, str(corpus), str(learned(folder, target))]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        raise FuzzError(f"{' '.join(command)}\n{done.stdout[-6000:]}")
    return len(list(corpus.iterdir())) - before


def fuzz(folder, target, seconds):
    """What the fuzzer printed, and whether it found a fault."""
    command = [
        str(folder / target),
        f"-max_total_time={seconds}",
        f"-max_len={TARGETS[target]}",
        "-entropic=0",  # weighing the inputs by entropy takes three times as long as running them
        "-timeout=20",
        "-rss_limit_mb=2048",
        "-print_final_stats=1",
        f"-artifact_prefix={folder}/{target}-",
        str(learned(folder, target)),  # new inputs are written to the first folder
        str(HERE / "corpus" / target),
    ]
    environment = {**os.environ, "ASAN_OPTIONS": "malloc_context_size=4:quarantine_size_mb=16"}
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment)
    return done.stdout, done.returncode != 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=int, default=600, help="for each target")
    parser.add_argument("--build", type=Path, required=True, help="build folder")
    parser.add_argument("--merge", action="store_true", help="then store what was learned")
    parser.add_argument("--json", type=Path, help="file for what all runs have seen, as the row of a benchmark")
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
            if arguments.merge:
                print(f"{target}: {merge(folder, target)} inputs are stored besides those of before", flush=True)
    except FuzzError as error:
        print(f"run_fuzz: {error}", file=sys.stderr)
        return 1
    finally:
        if arguments.json is not None and LEDGER.exists():
            arguments.json.write_text(json.dumps([row()], indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
