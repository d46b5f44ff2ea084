"""Runs the engine's adversaries, against open and sealed teams, and writes each row of JSON as it comes.

    bench_adversaries [--out FILE]

Each row: {what, bar, value, unit, holds, detail}. What each adversary does stands in
test/engine/test_adversary_suite.cpp and test_own_address.cpp; a test fails when a robot is deafened, a packet is not
delivered, or a table outgrows its bound.
"""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

from benchmark_rows import Rows
from namespaces import program

SEEDS = range(1, 11)  # of the radio and the robots
DEFAULT_SEEDS = range(1, 4)  # those with packets of the default's size, which take longer
PROCESSES = 19  # of each such seed, so that what the allocator keeps of one adversary is not counted for the next
MOST_MEMORY = 64  # MB, of the process with all its robots
SUITES = (("open team", "Open/AdversarySuite*"), ("sealed team", "Sealed/AdversarySuite*"))
PACKET = 1_000_000  # octets of the largest packet that robots take
DEFAULT_PACKET = 10_000_000  # the same where nobody has set max_packet_size
OTHERS = (
    ("rumours, searches and the air on a line of robots, open and sealed team", "*AdversaryInALine*"),
    ("single tables and budgets", "Adversary.*:LivingRuns.*:Reassembly.*:Bounds.*"),
)


def play(chosen, seed, packet=PACKET, process=0, processes=1):
    """What gtest reports of one of the processes that share these adversaries; `packet`: octets of the largest one."""
    with tempfile.NamedTemporaryFile(suffix=".json") as report:
        options = [f"--gtest_filter={chosen}", f"--gtest_output=json:{report.name}"]
        command = [program("adhoc_communication_engine_test"), *options]
        environment = {**os.environ, "ADVERSARY_SEED": str(seed), "ADVERSARY_LARGEST_PACKET": str(packet)}
        environment |= {"GTEST_TOTAL_SHARDS": str(processes), "GTEST_SHARD_INDEX": str(process)}
        subprocess.run(command, stdout=subprocess.DEVNULL, check=False, env=environment)
        return json.loads(Path(report.name).read_text() or '{"tests": 0}')


def success_row(name, reports):
    """How many had success; `reports`: one for each seed."""
    tests = [test for found in reports for suite in found.get("testsuites", []) for test in suite["testsuite"]]
    failed = sorted({test["name"] for test in tests if test.get("failures")})
    holds = all(found.get("testsuites") for found in reports) and not failed
    detail = f"{len({test['name'] for test in tests})} adversaries"
    if len(reports) > 1:
        detail += f", {len(reports)} seeds each"
    return {
        "what": f"adversaries that had success, {name}", "bar": "0", "value": len(failed), "unit": "", "holds": holds,
        "detail": detail + (f"; {', '.join(failed)}" if failed else ""),
    }  # fmt: skip


def memory_row(name, reports, packet=PACKET):
    """The worst of the seeds; `packet`: octets of the largest one taken."""
    peaks = [int(suite["peak_kilobytes"]) / 1000 for found in reports for suite in found.get("testsuites", [])]
    worst = max(peaks, default=0)
    each = packet == DEFAULT_PACKET
    adversaries = "each adversary, max_packet_size as by default" if each else "all adversaries"
    counted = f"{len(peaks)} {'processes' if each else 'seeds'}"
    return {
        "what": f"memory of three robots under attack by {adversaries}, {name}: peak of the process",
        "bar": f"<= {MOST_MEMORY}", "value": worst, "unit": "MB", "holds": 0 < worst <= MOST_MEMORY,
        "detail": f"worst of {counted}; packets of at most {packet / 1e6:.0f} MB",
    }  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, help="file for the rows as JSON")
    arguments = parser.parse_args()
    rows = Rows(arguments.out)
    for name, chosen in SUITES:
        reports = [play(chosen, seed) for seed in SEEDS]
        rows.add(success_row(name, reports))
        rows.add(memory_row(name, reports))
        each = [(seed, process) for seed in DEFAULT_SEEDS for process in range(PROCESSES)]
        reports = [play(chosen, seed, DEFAULT_PACKET, process, PROCESSES) for seed, process in each]
        rows.add(memory_row(name, reports, DEFAULT_PACKET))
    for name, chosen in OTHERS:
        rows.add(success_row(name, [play(chosen, SEEDS[0])]))
    return rows.status()
