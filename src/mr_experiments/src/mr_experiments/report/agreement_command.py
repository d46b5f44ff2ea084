"""Command line of ``rosrun mr_experiments agreement``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Sequence

from mr_experiments.common.command_line import BAD_CALL, CallError, Parser
from mr_experiments.report.agreement import agreements, notes_of, rows_of, stack_runs, virtual_runs, write_agreement
from mr_measures.record.files import RecordError


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="agreement",
        description="Compares missions of the whole ROS stack with trials of the same kind in virtual time. First: "
        "tools/bench_missions --runs 12 (or rosrun mr_launch team --out MISSIONS/..., several seeds and team sizes), "
        "and rosrun mr_experiments run --scenario launch --out RECORDS.",
        epilog="Exit code: 0 equivalent and every mission finished, 1 not shown, 2 bad call.",
    )
    parser.add_argument("missions", metavar="MISSIONS", type=Path, help="folder with output folders of mr_launch team")
    parser.add_argument("records", metavar="RECORDS", type=Path, help="folder with records of mr_experiments run")
    parser.add_argument(
        "--out", type=Path, default=Path("out/agreement"), metavar="DIR", help="for agreement.json, which keeps "
        "former comparisons, and agreement.png (default: %(default)s)"
    )  # fmt: skip
    return parser


def main(arguments: Sequence[str]) -> int:
    try:
        options = make_parser().parse_args(arguments)
        found = agreements(stack_runs(options.missions), virtual_runs(options.records))
        files = write_agreement(found, options.out)
    except (CallError, RecordError, OSError) as error:
        print(f"agreement: {error}", file=sys.stderr)
        return BAD_CALL
    for entry in found:
        for row in rows_of(entry):
            mark = "ok  " if row["holds"] else "MISS"
            print(f"{mark} {row['what']}: {row['value']} {row['unit']} (bar {row['bar']}) {row['detail']}")
    for note in notes_of(found):
        print(f"Note: {note}")
    print("Files: " + ", ".join(str(path) for path in files))
    return 0 if all(entry.holds for entry in found) else 1
