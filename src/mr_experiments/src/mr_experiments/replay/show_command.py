"""The command ``rosrun mr_experiments show``: a replay of one recorded mission to look at in a browser."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from mr_experiments.common.command_line import BAD_CALL, INTERRUPTED, CallError, Parser
from mr_experiments.replay.replay import load_record, make_page
from mr_experiments.replay.replay_data import ReplayError


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="show",
        description="Writes the replay of a recorded mission as one HTML file that any browser opens, without network.",
        epilog="Maps grow as they did if the trial was run with --snapshots; otherwise their growth is reconstructed. "
        "Exit code: 0 written, 2 bad call or bad record.",
    )
    parser.add_argument(
        "record",
        metavar="RECORD",
        help="record (JSON) that `run` or `rosrun mr_launch team` wrote",
    )
    parser.add_argument("--out", default="", metavar="FILE", help="HTML file to write (default: beside the record)")
    return parser


def main(arguments: Sequence[str]) -> int:
    """``rosrun mr_experiments show RECORD [--out FILE]``; returns the exit code."""
    try:
        options = make_parser().parse_args(arguments)
        path = Path(options.record)
        record = load_record(path)
        out = Path(options.out) if options.out else path.with_suffix(".html")
        check_output(out, path)
        write_page(out, make_page(record))
    except (CallError, ReplayError) as error:
        print(f"show: {error}", file=sys.stderr)
        return BAD_CALL
    except KeyboardInterrupt:
        print("show: interrupted, nothing was written", file=sys.stderr)
        return INTERRUPTED
    print(f"{out} ({out.stat().st_size / 1e6:.1f} MB): open it in a browser")
    return 0


def check_output(out: Path, record: Path) -> None:
    """Raises ReplayError for a file that must not or cannot be written."""
    if out.is_dir():
        raise ReplayError(f"--out {out} is a folder: give the name of a file")
    if out.exists() and record.exists() and out.samefile(record):
        raise ReplayError(f"--out {out} is the record itself: give another file")
    if not out.absolute().parent.is_dir():
        raise ReplayError(f"the folder {out.absolute().parent} for the page does not exist: create it or change --out")


def write_page(out: Path, page: str) -> None:
    try:
        out.write_text(page, encoding="utf-8")
    except OSError as error:
        raise ReplayError(f"cannot write {out}: {error.strerror}; give another file with --out") from None
