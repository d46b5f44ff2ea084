"""Arguments of the command line, and what a person sees when something is wrong with them."""

import argparse
import sys
from typing import List, Optional

import cv2

from mr_grid.map_files import MapFileError
from mr_grid.option_types import finite, picture

from . import bench, merge, register

USAGE = 2
"""Exit code for arguments and files that cannot be used."""


def main(arguments: Optional[List[str]] = None) -> int:
    """Runs one command. Exit code 0: done, 2: arguments or files that cannot be used, 3: maps that were not placed."""
    options = _parser().parse_args(arguments)
    cv2.setNumThreads(1)
    try:
        return int(options.run(options))
    except MapFileError as error:
        return _complain(str(error))
    except ModuleNotFoundError as error:
        return _complain(f"{error.name} is not installed")
    except OSError as error:
        return _complain(f"{error.filename or 'output'}: {error.strerror or error}")


def _complain(text: str) -> int:
    print(f"map_merger: {text}", file=sys.stderr)
    return USAGE


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python3 -m map_merger", description="Registers and merges maps in files.")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    pair = commands.add_parser("register", help="transform between two maps", description=register.__doc__)
    pair.add_argument("target", metavar="A.yaml", help="map_server file of the first map")
    pair.add_argument("source", metavar="B.yaml", help="map_server file of the second map")
    known = pair.add_mutually_exclusive_group()
    known.add_argument(
        "--prior",
        nargs=3,
        type=finite,
        metavar=("X", "Y", "YAW"),
        help="rough transform of B into A's frame in m and rad; looked for within 3 m and 30 deg",
    )
    known.add_argument("--sure", action="store_true", help="accept only what a copy of a room hardly ever fakes")
    pair.add_argument("--json", action="store_true", help="print the answer as JSON")
    pair.add_argument("--plot", type=picture, metavar="OUT.png", help="draw B over A (needs matplotlib)")
    pair.set_defaults(run=register.run)
    several = commands.add_parser("merge", help="one map out of several", description=merge.__doc__)
    several.add_argument("maps", nargs="+", metavar="MAP.yaml", help="map_server files; the first one gives the frame")
    several.add_argument("-o", "--out", required=True, metavar="OUT", help="writes OUT.pgm and OUT.yaml")
    several.set_defaults(run=merge.run)
    measured = commands.add_parser("bench", help="measure registration", description=bench.__doc__)
    measured.add_argument(
        "pairs", nargs="?", type=_count, default=20, metavar="PAIRS", help="number of pairs (default 20)"
    )
    measured.set_defaults(run=bench.run)
    return parser


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"a number of at least 1 is needed, not {text!r}")
    return int(text)
