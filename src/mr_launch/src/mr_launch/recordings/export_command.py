"""``rosrun mr_launch export``: options, progress and errors."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Sequence

from mr_launch.errors import UserError
from mr_launch.exit_codes import BAD_CALL, FAILED, INTERRUPTED, OK
from mr_launch.recordings.bags import SECOND
from mr_launch.recordings.recording import WHAT_IS_FOUND, Recording, find_recording, with_messages


def make_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="export",
        description="Writes a recorded mission as one MCAP of ROS 2, which Foxglove, Lichtblick and Rerun open: topics "
        "and frames below the names of the robots, one time, one tree of frames below 'world'.",
        epilog="Exit code: 0 written, 1 it could not be written, 2 bad options or bags, 130 interrupted.",
    )
    add = parser.add_argument
    add("mission", metavar="MISSION", type=Path, help=WHAT_IS_FOUND)
    add("--out", type=Path, metavar="FILE.mcap", help="default: mission.mcap in MISSION, NAME.mcap beside a bag")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--topics", nargs="+", default=[], metavar="NAME", help="only these, as a robot calls them "
        "(default: what viewers show)")  # fmt: skip
    which.add_argument("--all", action="store_true", help="all topics, also what the radio brought")
    add("--compress", action="store_true", help="compress the chunks of the file with Zstandard")
    return parser


def main(arguments: Sequence[str]) -> int:
    options = make_parser().parse_args(arguments)
    try:
        recording = find_recording(options.mission)
        target = _target(options.mission.resolve(), options.out)
        return _written(recording, target, options)
    except UserError as error:
        print(f"export: {error}", file=sys.stderr)
        return BAD_CALL
    except OSError as error:
        print(f"export: {error.filename or options.mission} cannot be written: {error.strerror}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        print("export: interrupted, nothing was written", file=sys.stderr)
        return INTERRUPTED


def _written(recording: Recording, target: Path, options: argparse.Namespace) -> int:
    try:
        return _export(recording, target, options)
    except OSError as error:  # names what is written on the way
        print(f"export: {target} cannot be written: {error.strerror}; choose another place with --out", file=sys.stderr)
        return FAILED


def _target(mission: Path, out: Path | None) -> Path:
    target = out or (mission / "mission.mcap" if mission.is_dir() else mission.with_suffix(".mcap"))
    if target.suffix != ".mcap":
        raise UserError(f"--out {target}: the name has to end with .mcap")
    if target.exists():
        raise UserError(f"{target} is there already; remove it, or choose another name with --out")
    if not target.parent.is_dir():
        raise UserError(f"there is no folder {target.parent} for --out")
    return target


def _export(recording: Recording, target: Path, options: argparse.Namespace) -> int:
    try:
        from mr_launch.recordings.export import export
    except ModuleNotFoundError as error:
        raise UserError(
            f"the Python package {error.name} is missing: run tools/install_dependencies, then source "
            "tools/environment.sh"
        ) from None
    recording = with_messages(recording)
    for note in recording.notes:
        print(f"export: {note}", file=sys.stderr)
    result = export(recording, target, options.topics, options.all, options.compress, Progress())
    for name in result.untied:
        print(f"export: nothing tells where {name} was; its frames have no way to the others", file=sys.stderr)
    for name in result.untimed:
        print(f"export: nothing ties the clock of {name} to the others; its times are its own", file=sys.stderr)
    for (bag, topic), count in result.broken.items():
        print(f"export: {bag}, {topic}: left out what cannot be decoded, messages: {count}", file=sys.stderr)
    seconds = (result.span[1] - result.span[0]) / SECOND
    robots = ", ".join(robot.name for robot in recording.robots)
    size = target.stat().st_size / 1e6
    print(
        f"{target}: {robots}, {seconds:.1f} s, {len(result.topics)} topics, {result.messages} messages, {size:.1f} MB"
    )
    return OK


class Progress:
    """On a terminal a line that is written over, else nothing."""

    def __init__(self) -> None:
        self._shows = sys.stderr.isatty()

    def __call__(self, share: float) -> None:
        if self._shows:
            end = "\r" if share < 1.0 else "\n"
            print(f"export: {share:4.0%}", end=end, file=sys.stderr, flush=True)
