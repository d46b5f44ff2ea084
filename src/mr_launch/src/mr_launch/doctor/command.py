"""``rosrun mr_launch doctor``: options and output."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from typing import Sequence

from mr_launch.doctor.diagnosis import diagnose
from mr_launch.exit_codes import INTERRUPTED

HEALTHY, FAULTS = 0, 1


def make_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="doctor",
        description="Says what is wrong with this robot and what to do, one line each: WHAT: REMEDY. It asks the ROS "
        "master that ROS_MASTER_URI names; without one it looks at the computer alone.",
        epilog="Exit code: 0 nothing is wrong, 1 something is, 2 bad options, 130 interrupted.",
    )
    add = parser.add_argument
    add(
        "--interface",
        default="",
        metavar="NAME",
        help="network interface of the radio (default: that of the running node)",
    )
    add("--key-file", default="", metavar="FILE", help="file with the team's keys (default: that of the running node)")
    add(
        "--peers",
        nargs="+",
        default=[],
        metavar="NAME",
        help="robots that have to be in reach (default: none)",
    )
    add("--seconds", type=float, default=4.0, metavar="S", help="how long to listen, 1 to 60 (default: %(default)s)")
    add("--json", action="store_true", help="print a list of {part, what, remedy}")
    add("--verbose", action="store_true", help="say so when nothing is wrong")
    return parser


def names_of(words: Sequence[str]) -> tuple[str, ...]:
    """Robots, with blanks or commas between."""
    return tuple(name.strip() for name in ",".join(words).split(",") if name.strip())


def main(arguments: Sequence[str]) -> int:
    """Words that roslaunch adds (`__name:=...`) are passed over."""
    parser = make_parser()
    given = parser.parse_args([word for word in arguments if ":=" not in word])
    if not 1.0 <= given.seconds <= 60.0:
        parser.error(f"--seconds {given.seconds:g} is out of range: 1 to 60")
    try:
        from mr_launch.doctor.examination import Wanted, examine  # ROS, not needed for --help

        findings = diagnose(examine(Wanted(given.interface, given.key_file, names_of(given.peers), given.seconds)))
    except KeyboardInterrupt:
        print("doctor: interrupted", file=sys.stderr)
        return INTERRUPTED
    if given.json:
        print(json.dumps([asdict(finding) for finding in findings], indent=2))
    else:
        for finding in findings:
            print(finding)
        if given.verbose and not findings:
            print("all well")
    sys.stdout.flush()
    return FAULTS if findings else HEALTHY
