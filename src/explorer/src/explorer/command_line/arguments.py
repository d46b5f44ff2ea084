"""Arguments of the command line, and what a person sees when something is wrong with them."""

import argparse
import sys
from typing import List, Optional

import cv2

from explorer.command_line import decide, frontiers
from explorer.errors import ExplorerError
from explorer.options import DEFAULTS
from mr_grid.option_types import finite, picture, positive

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
        type=finite,
        metavar=("X", "Y"),
        help="the robot's place in m; without it the robot is in the largest space",
    )
    one.add_argument("--radius", type=positive, default=DEFAULTS["inflation_radius"], help=_told("m, inflation_radius"))
    one.add_argument(
        "--shortest",
        type=finite,
        default=DEFAULTS["minimal_frontier_length"],
        metavar="LENGTH",
        help=_told("m, minimal_frontier_length"),
    )
    one.add_argument(
        "--view-distance", type=positive, default=DEFAULTS["view_distance"], help=_told("m, view_distance")
    )
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
    command.add_argument("--plot", type=picture, metavar="OUT.png", help="draw it (needs matplotlib)")


def _told(what: str) -> str:
    return f"{what} (default %(default)s)"
