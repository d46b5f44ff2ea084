"""Arguments of the command line, and what a person sees when something is wrong with them."""

import argparse
import math
import sys
from typing import List, Optional

import cv2

from explorer.command_line import decide, frontiers
from explorer.errors import ExplorerError
from explorer.options import Options

USAGE = 2
"""Exit code for arguments and files that cannot be used."""


def main(arguments: Optional[List[str]] = None) -> int:
    """Runs one command. Exit code 0: done, 2: arguments or files that cannot be used."""
    given = _parser().parse_args(arguments)
    cv2.setNumThreads(1)
    try:
        return int(given.run(given))
    except ExplorerError as error:
        return _complain(str(error))
    except ModuleNotFoundError as error:
        return _complain(f"{error.name} is not installed")
    except BrokenPipeError:
        sys.stderr.close()  # the reader has seen enough
        return 0
    except OSError as error:
        return _complain(f"{error.filename or 'output'}: {error.strerror or error}")


def _complain(text: str) -> int:
    print(f"explorer: {' '.join(text.split())}", file=sys.stderr)
    return USAGE


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python3 -m explorer", description="Shows what the explorer sees on a map, and how it decides."
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    one = commands.add_parser("frontiers", help="frontiers and clusters of a map", description=frontiers.__doc__)
    one.add_argument("map", metavar="MAP.yaml", help="map_server file")
    one.add_argument(
        "--at",
        nargs=2,
        type=_finite,
        metavar=("X", "Y"),
        help="the robot's place in m; without it the robot is in the largest space",
    )
    one.add_argument("--radius", type=_positive, default=Options.inflation_radius, help=_told("m, inflation_radius"))
    one.add_argument(
        "--shortest",
        type=_finite,
        default=Options.minimal_frontier_length,
        metavar="LENGTH",
        help=_told("m, minimal_frontier_length"),
    )
    one.add_argument("--view-distance", type=_positive, default=Options.view_distance, help=_told("m, view_distance"))
    _add_outputs(one)
    one.set_defaults(run=frontiers.run)
    two = commands.add_parser("decide", help="replay a recorded decision", description=decide.__doc__)
    two.add_argument("scene", metavar="SCENE.json", help="file recorded with the parameter ~scene_path")
    two.add_argument("--strategy", metavar="N|NAME", help="decide by this strategy instead of the recorded one")
    _add_outputs(two)
    two.set_defaults(run=decide.run)
    return parser


def _add_outputs(command: argparse.ArgumentParser) -> None:
    command.add_argument("--json", action="store_true", help="print the answer as JSON")
    command.add_argument("--plot", type=_picture, metavar="OUT.png", help="draw it (needs matplotlib)")


def _told(what: str) -> str:
    return f"{what} (default %(default)s)"


def _finite(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise argparse.ArgumentTypeError(f"a finite number is needed, not {text!r}")
    return number


def _positive(text: str) -> float:
    number = _finite(text)
    if number <= 0.0:
        raise argparse.ArgumentTypeError(f"a number above 0 is needed, not {text!r}")
    return number


def _picture(text: str) -> str:
    if not text.endswith((".png", ".pdf", ".svg")):
        raise argparse.ArgumentTypeError(f"a name that ends in .png, .pdf or .svg is needed, not {text!r}")
    return text
