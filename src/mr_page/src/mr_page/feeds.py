"""How the pages' feeds of a team's robots, each at its own master, reach the one server of the team's page: a Unix
socket over which each sends its name, then updates, and gets commands back, all with their length before them."""

from __future__ import annotations

import asyncio
import json
import socket
import struct
from typing import Any

from tornado.ioloop import IOLoop
from tornado.iostream import IOStream, StreamClosedError
from tornado.netutil import add_accept_handler, bind_unix_socket

from mr_page.commands import SERVICES, Answer, Order
from mr_page.radio_switch import RadioSwitch
from mr_page.state import PageState
from mr_page.update import decoded

LENGTH = struct.Struct(">I")
MAX_UPDATE = 8_000_000  # octets
PATIENCE = 10.0  # s to wait for the answer to a command


class FeedServer:
    """Fills a state with what all feeds tell.

    Args:
        path: of the socket, made anew.
        radio: switches the radios of simulated robots; None: there is none.
    """

    def __init__(self, state: PageState, path: str, radio: RadioSwitch | None = None) -> None:
        self._state = state
        self._radio = radio
        self._feeds: dict[str, _Feed] = {}
        self._remove = add_accept_handler(bind_unix_socket(path), self._accept)

    def close(self) -> None:
        self._remove()
        for feed in list(self._feeds.values()):
            feed.stream.close()

    async def command(self, robot: str, order: Order) -> Answer:
        """Have it done by the robot's feed, or by the radio daemon."""
        if order.command not in SERVICES:
            return self._switch(robot, order.command)
        feed = self._feeds.get(robot)
        if feed is None:
            return Answer(False, f"{robot} does not feed this page at the moment")
        return await feed.ask(order)

    def _switch(self, robot: str, command: str) -> Answer:
        if self._radio is None:
            return Answer(False, "only radios of simulated robots can be switched from here")
        answer = self._radio.switch(robot, command)
        if answer.done:
            self._state.put(robot, "radio_off", command == "radio_off")
        return answer

    def _accept(self, connection: socket.socket, _address: Any) -> None:
        IOLoop.current().add_callback(self._serve, IOStream(connection, max_buffer_size=2 * MAX_UPDATE))

    async def _serve(self, stream: IOStream) -> None:
        name = ""
        try:
            name = (await read_message(stream)).decode()
            self._enter(name, _Feed(stream))
            while True:
                self._take(name, await read_message(stream))
        except (StreamClosedError, ValueError, KeyError, TypeError):  # gone, or what it tells is no update
            stream.close()
        finally:
            self._leave(name, stream)

    def _enter(self, name: str, feed: _Feed) -> None:
        before = self._feeds.get(name)
        if before is not None:
            before.stream.close()
        radio_off = self._state.get(name, "radio_off")
        self._state.forget(name)
        self._state.put(name, "lost", False)
        if radio_off:
            self._state.put(name, "radio_off", True)  # of the radio daemon, which goes on
        self._state.put(name, "switchable", self._radio is not None)
        self._feeds[name] = feed

    def _leave(self, name: str, stream: IOStream) -> None:
        feed = self._feeds.get(name)
        if feed is not None and feed.stream is stream:
            del self._feeds[name]
            feed.give_up(f"the feed of {name} is gone")
            self._state.put(name, "lost", True)

    def _take(self, name: str, message: bytes) -> None:
        """An answer to a command begins with {, an update with its length."""
        if message[:1] == b"{":
            answer = json.loads(message)
            self._feeds[name].answered(Answer(bool(answer["done"]), str(answer["text"])))
            return
        update = decoded(message)
        update.anew.clear()  # a feed that begins anew has a connection of its own
        told = {*update.robots, *(robot for robot, *_ in update.lattices), *(robot for robot, *_ in update.tiles)}
        if not told <= {name}:
            raise ValueError(f"the feed of {name} speaks for {', '.join(sorted(told - {name}))}")
        self._state.apply(update)


class _Feed:
    """One robot's feed; answers come in the order of the commands."""

    def __init__(self, stream: IOStream) -> None:
        self.stream = stream
        self._waiting: list[asyncio.Future[Answer]] = []

    async def ask(self, order: Order) -> Answer:
        answer: asyncio.Future[Answer] = asyncio.get_running_loop().create_future()
        self._waiting.append(answer)
        try:
            await self.stream.write(framed(json.dumps(order).encode()))
            return await asyncio.wait_for(answer, PATIENCE)
        except StreamClosedError:
            return Answer(False, "the robot's feed is gone")
        except asyncio.TimeoutError:
            return Answer(False, f"no answer within {PATIENCE:.0f} s")

    def answered(self, answer: Answer) -> None:
        if self._waiting:
            waiting = self._waiting.pop(0)
            if not waiting.done():
                waiting.set_result(answer)

    def give_up(self, text: str) -> None:
        while self._waiting:
            self.answered(Answer(False, text))


class FeedLink:
    """A feed's end of the socket, for programs that block. OSError when the other end is gone."""

    def __init__(self, path: str, robot: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._socket.connect(path)
        self._buffer = b""
        self.send(robot.encode())

    def send(self, message: bytes) -> None:
        self._socket.sendall(framed(message))

    def answer(self, answer: Answer) -> None:
        self.send(json.dumps({"done": answer.done, "text": answer.text}).encode())

    def orders(self, seconds: float) -> list[Order]:
        """Those that come within `seconds`; returns at the first."""
        self._socket.settimeout(seconds)
        try:
            data = self._socket.recv(65536)
        except TimeoutError:
            return []
        finally:
            self._socket.settimeout(None)
        if not data:
            raise ConnectionError("the page's server is gone")
        self._buffer += data
        return [Order(command, to, tuple(limits)) for command, to, limits in map(json.loads, self._messages())]

    def close(self) -> None:
        self._socket.close()

    def _messages(self) -> list[bytes]:
        found = []
        while len(self._buffer) >= LENGTH.size:
            end = LENGTH.size + LENGTH.unpack_from(self._buffer)[0]
            if len(self._buffer) < end:
                break
            found.append(self._buffer[LENGTH.size : end])
            self._buffer = self._buffer[end:]
        return found


def framed(message: bytes) -> bytes:
    return LENGTH.pack(len(message)) + message


async def read_message(stream: IOStream) -> bytes:
    """ValueError for one that is too long."""
    (length,) = LENGTH.unpack(await stream.read_bytes(LENGTH.size))
    if length > MAX_UPDATE:
        raise ValueError(f"a message of {length} octets; {MAX_UPDATE} are accepted")
    return bytes(await stream.read_bytes(length))
