"""The status page of a simulated team, started by its runner: ``python3 -m mr_page.team_page --help``."""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import signal
import socket
import sys

from mr_page.address import ADDRESS, PORT
from mr_page.feeds import FeedServer
from mr_page.radio_switch import RadioSwitch
from mr_page.server import PageServer, listening_sockets, quiet_logs
from mr_page.state import PageState

MAX_PORT = 65535


def make_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="team_page", description="Serves the status page of a team.")
    parser.add_argument("--feeds", required=True, metavar="PATH", help="Unix socket for the robots' feeds")
    parser.add_argument("--radio", default="", metavar="PATH", help="control socket of the radio daemon")
    parser.add_argument("--title", default="Team", help="of the page")
    parser.add_argument("--descriptor", type=int, help="listening socket to serve, in place of address and port")
    parser.add_argument("--address", default=ADDRESS, help="to listen at (default: %(default)s)")
    parser.add_argument("--port", type=int, default=PORT, help="default: %(default)s")
    return parser


async def serve(options: argparse.Namespace) -> None:
    """Until SIGTERM or SIGINT."""
    state = PageState()
    radio = RadioSwitch(options.radio) if options.radio else None
    try:
        feeds = FeedServer(state, options.feeds, radio)
    except ValueError:
        raise OSError(f"--feeds {options.feeds} is there already, and no socket; give another path") from None
    except OSError as error:
        why = error.strerror or error
        raise OSError(f"--feeds {options.feeds} cannot be made: {why}; give a path in a folder of yours") from None
    server = PageServer(state, options.title, feeds.command)
    if options.descriptor is not None:
        given = socket.socket(fileno=options.descriptor)
        given.setblocking(False)
        server.add_sockets([given])
    else:
        server.add_sockets(listening_sockets(options.port, options.address))
    end = asyncio.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        asyncio.get_running_loop().add_signal_handler(number, end.set)
    await end.wait()
    server.close()
    feeds.close()


def main() -> int:
    quiet_logs()
    parser = make_parser()
    options = parser.parse_args()
    if not 1 <= options.port <= MAX_PORT:
        parser.error(f"--port {options.port} is out of range: 1 to {MAX_PORT}")
    try:
        with contextlib.suppress(KeyboardInterrupt):
            asyncio.run(serve(options))
    except OSError as error:
        print(f"team_page: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
