"""``rosrun mr_launch link``: frames of adhoc_communication over a link of one's own, where no network interface carries
raw Ethernet frames. The node reaches it as it reaches a radio daemon, at a hub socket."""

from __future__ import annotations

import argparse
import contextlib
import os
import selectors
import signal
import socket
import stat
import sys
from pathlib import Path
from typing import Callable, Protocol, Sequence

from mr_grid.by_place import PlaceError, object_at
from mr_launch.errors import UserError
from mr_launch.exit_codes import BAD_CALL, FAILED, OK
from mr_launch.option_parser import OptionParser

LARGEST_FRAME = 4096  # octets with the Ethernet header
MOST_CLIENTS = 8  # the node, and others that look whether somebody answers
NEEDED = ("fileno", "send", "receive")


class Link(Protocol):
    """What a link is: an object made with the name of the interface, empty if none was given. Frames begin with their
    Ethernet header (14 octets), have LARGEST_FRAME octets at most, and may be lost, repeated or reordered, never
    altered. None of its calls waits."""

    def fileno(self) -> int:
        """Readable when `receive` may have frames."""

    def send(self, frame: bytes) -> None:
        """To all that hear this robot. OSError for a frame that cannot be sent, which is lost then."""

    def receive(self) -> list[bytes]:
        """Frames that have come, or BlockingIOError when none have; those of this robot itself do no harm. Any other
        OSError means that the link is gone: the program ends and says so."""


def link_at(place: str, interface: str) -> Link:
    """The link whose class stands at `module:Class` or `path/file.py:Class`. Raises UserError."""
    try:
        kind: Callable[[str], Link] = object_at(place)
        link = kind(interface)
    except PlaceError as error:
        raise UserError(f"link {error}") from None
    except Exception as error:  # whatever the user's class raises
        raise UserError(f"link {place!r} with the interface {interface!r}: {type(error).__name__}: {error}") from error
    missing = [name for name in NEEDED if not callable(getattr(link, name, None))]
    if missing:
        raise UserError(f"link {place!r}: it has no {', '.join(missing)}; see mr_launch.link.Link")
    return link


class Hub:
    """A hub socket: SOCK_SEQPACKET, the first message of a client is its robot's name, each further one a frame. Frames
    that a client does not take at once are lost."""

    def __init__(self, path: Path, link: Link) -> None:
        """Raises UserError if the socket cannot be had."""
        self._path, self._link = path, link
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._listener.setblocking(False)
        self._named: dict[socket.socket, bool] = {}
        self._selector = selectors.DefaultSelector()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            _remove_socket(path)
            _listen(self._listener, path)
        except OSError as error:
            raise UserError(f"no hub socket at {path}: {error.strerror or error}") from error
        self._selector.register(self._listener, selectors.EVENT_READ, self._accept)
        self._selector.register(link.fileno(), selectors.EVENT_READ, self._hear)

    def watch(self, descriptor: int) -> None:
        """`step` returns when there is something to be read, too, which is left there."""
        self._selector.register(descriptor, selectors.EVENT_READ, lambda: None)

    def step(self, timeout: float | None = None) -> None:
        """Pass on what has come; waits for it up to `timeout` s. OSError when the link is gone."""
        for key, _ in self._selector.select(timeout):
            key.data()

    def close(self) -> None:
        for client in list(self._named):
            self._drop(client)
        self._selector.close()
        self._listener.close()
        with contextlib.suppress(OSError):
            _remove_socket(self._path)

    def _accept(self) -> None:
        client, _ = self._listener.accept()
        if len(self._named) >= MOST_CLIENTS:
            client.close()
            return
        client.setblocking(False)
        self._named[client] = False
        self._selector.register(client, selectors.EVENT_READ, lambda: self._take(client))

    def _take(self, client: socket.socket) -> None:
        try:
            message = client.recv(LARGEST_FRAME)
        except OSError:
            message = b""
        if not message:
            self._drop(client)
        elif not self._named[client]:
            self._named[client] = True
        else:
            with contextlib.suppress(OSError):
                self._link.send(message)

    def _hear(self) -> None:
        with contextlib.suppress(BlockingIOError):
            for frame in self._link.receive():
                for client in self._named:
                    with contextlib.suppress(OSError):
                        client.send(frame)

    def _drop(self, client: socket.socket) -> None:
        del self._named[client]
        self._selector.unregister(client)
        client.close()


def _listen(listener: socket.socket, path: Path) -> None:
    """Who sees the socket at `path` can connect: it gets its name when it listens already. Raises OSError."""
    unready = path.with_name(path.name + "~")
    _remove_socket(unready)
    listener.bind(str(unready))
    listener.listen()
    unready.rename(path)


def _remove_socket(path: Path) -> None:
    """What an earlier hub left, and nothing else. Raises OSError."""
    try:
        mode = path.lstat().st_mode
    except FileNotFoundError:
        return
    if not stat.S_ISSOCK(mode):
        raise OSError("there is something else, which is no socket; choose another path")
    path.unlink(missing_ok=True)


def make_parser() -> argparse.ArgumentParser:
    parser = OptionParser(prog="link", description=__doc__.replace("``", ""))
    add = parser.add_argument
    add("--link", required=True, metavar="PLACE", help="class of the link: module:Class or FILE.py:Class")
    add("--hub", required=True, metavar="PATH", help="socket to make; adhoc_communication has interface:=hub:PATH")
    add("--interface", default="", metavar="NAME", help="given to the class (default: none)")
    return parser


def main(arguments: Sequence[str]) -> int:
    """Until SIGTERM or SIGINT. Words that roslaunch adds (`__name:=...`) are passed over."""
    try:
        options = make_parser().parse_args([word for word in arguments if ":=" not in word])
        hub = Hub(Path(options.hub), link_at(options.link, options.interface))
    except UserError as error:
        print(f"link: {error}", file=sys.stderr)
        return BAD_CALL
    ends: list[int] = []
    reader, writer = os.pipe()  # a signal wakes the selector
    os.set_blocking(writer, False)
    signal.set_wakeup_fd(writer)
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda number, _: ends.append(number))
    hub.watch(reader)
    try:
        while not ends:
            hub.step()
    except OSError as error:
        print(f"link: {options.link} is gone: {error}", file=sys.stderr)
        return FAILED
    finally:
        hub.close()
    return OK
