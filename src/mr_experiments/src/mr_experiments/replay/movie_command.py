"""The command ``rosrun mr_experiments movie``: a moving picture of one recorded mission."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from mr_experiments.common.command_line import BAD_CALL, INTERRUPTED, CallError, Parser
from mr_experiments.replay.movie import Film, make_movie
from mr_experiments.replay.replay import load_record
from mr_experiments.replay.replay_data import ReplayError
from mr_experiments.replay.show_command import check_output
from mr_page.browser import BrowserError

WIDTHS, SECONDS, RATES = (200, 2000), (1.0, 120.0), (1, 25)


def make_parser() -> argparse.ArgumentParser:
    film = Film()
    parser = Parser(
        prog="movie",
        description="Writes the replay of a recorded mission as a GIF: the page of `show` in a headless Chromium.",
        epilog="Maps grow as they did if the trial was run with --snapshots; otherwise their growth is reconstructed. "
        "Exit code: 0 written, 2 bad call, bad record or no browser.",
    )
    add = parser.add_argument
    add("record", metavar="RECORD", help="record (JSON) that `run` or `rosrun mr_launch team` wrote")
    add("--out", default="", metavar="FILE", help="GIF to write (default: beside the record)")
    add("--width", type=int, default=film.width, help="pixels (default: %(default)s)")
    add("--seconds", type=float, default=film.seconds, help="from begin to end of the mission (default: %(default)g)")
    add("--rate", type=int, default=film.rate, help="pictures in a second (default: %(default)s)")
    add("--dark", action="store_true", help="the page's dark colours")
    return parser


def film_of(options: argparse.Namespace) -> Film:
    """Raises CallError for what no movie can be."""
    for name, (least, most) in (("width", WIDTHS), ("seconds", SECONDS), ("rate", RATES)):
        if not least <= getattr(options, name) <= most:
            raise CallError(f"--{name} {getattr(options, name):g} is not within {least:g} to {most:g}")
    return Film(options.width, options.seconds, options.rate, options.dark)


def main(arguments: Sequence[str]) -> int:
    """``rosrun mr_experiments movie RECORD [--out FILE]``; returns the exit code."""
    try:
        options = make_parser().parse_args(arguments)
        path = Path(options.record)
        film, record = film_of(options), load_record(path)
        out = Path(options.out) if options.out else path.with_suffix(".gif")
        check_output(out, path)
        out.write_bytes(make_movie(record, film))
    except (CallError, ReplayError, BrowserError) as error:
        print(f"movie: {error}", file=sys.stderr)
        return BAD_CALL
    except OSError as error:
        print(f"movie: {error.filename}: {error.strerror}", file=sys.stderr)
        return BAD_CALL
    except KeyboardInterrupt:
        print("movie: interrupted, nothing was written", file=sys.stderr)
        return INTERRUPTED
    print(f"{out} ({out.stat().st_size / 1e6:.1f} MB)")
    return 0
