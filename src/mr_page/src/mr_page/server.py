"""The web server of a page: the page itself, and a web socket that tells each viewer what is new."""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import json
import logging
import socket
from typing import Any

from tornado.httpserver import HTTPServer
from tornado.ioloop import IOLoop, PeriodicCallback
from tornado.netutil import bind_sockets
from tornado.web import Application, HTTPError, RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from mr_page.commands import Answer, Command, Order
from mr_page.document import POLICY, self_contained
from mr_page.past import Past
from mr_page.state import PageState
from mr_page.update import Update, encoded
from mr_page.viewer import PERIOD, Viewer

MAX_VIEWERS = 16
MAX_ORDERS = 16  # of a viewer at a time
QUIET = 1.5  # s without news after which a viewer is told that there are none; pages wait 5 s
MAX_REQUEST = 4096  # octets of a message from a browser


class PageServer:
    """Serves a state that somebody else changes, on the event loop that is current when it is made.

    Args:
        title: of the page.
        command: asks a robot for something.
    """

    def __init__(self, state: PageState, title: str, command: Command) -> None:
        self._page = self_contained("status", title).encode()
        handlers: list[Any] = [("/", _Page, {"page": self._page}), ("/live", _Live, {"server": self})]
        self._http = HTTPServer(Application(handlers, websocket_ping_interval=10), max_body_size=MAX_REQUEST)
        self._state = state
        self._command = command
        self._viewers: set[_Live] = set()
        self._past = Past(state)
        self._ticks = PeriodicCallback(self._tell, 1000.0 * PERIOD / 3.0)
        self._ticks.start()

    def add_sockets(self, sockets: list[socket.socket]) -> None:
        """Listen on these."""
        self._http.add_sockets(sockets)

    def close(self) -> None:
        self._ticks.stop()
        self._http.stop()
        for viewer in list(self._viewers):
            viewer.close()

    def enter(self, viewer: _Live) -> Viewer | None:
        """A viewer came; None if there are too many."""
        if len(self._viewers) >= MAX_VIEWERS:
            return None
        self._viewers.add(viewer)
        made = Viewer(self._state)
        made.wants = lambda robot, kind: False  # until the page says what it shows
        return made

    def leave(self, viewer: _Live) -> None:
        self._viewers.discard(viewer)

    async def order(self, robot: str, order: Order) -> Answer:
        """What a viewer asks of a robot."""
        fault = order.fault()
        if not fault and robot not in self._state.robots:
            fault = f"there is no robot {robot!r} here"
        return Answer(False, fault) if fault else await self._command(robot, order)

    def past(self, time: float, viewer: Viewer) -> Update | None:
        """What a viewer would have seen at `time` of the team's clock, s."""
        return self._past.at(time, viewer.wants)

    def _tell(self) -> None:
        self._past.note(IOLoop.current().time())
        for viewer in list(self._viewers):
            viewer.tell()


class _Handler(RequestHandler):
    """Only for those who name this computer: a page of another site must not talk to a robot in a viewer's name."""

    def prepare(self) -> None:
        if not is_own_name(self.request.host):
            raise HTTPError(403, f"{self.request.host} is no name of this computer")

    def log_exception(self, *_: Any) -> None:
        """Bad requests are told to those who make them."""


class _Page(_Handler):
    def initialize(self, page: bytes) -> None:
        self._page = page

    def get(self) -> None:
        self.set_header("Content-Type", "text/html; charset=utf-8")
        self.set_header("Content-Security-Policy", POLICY)
        self.set_header("Cache-Control", "no-store")
        self.set_header("X-Frame-Options", "DENY")
        self.write(self._page)


class _Live(_Handler, WebSocketHandler):
    """One viewer. The next update waits until the last one has gone out."""

    def initialize(self, server: PageServer) -> None:
        self._server = server
        self._viewer: Viewer | None = None
        self._busy = False
        self._told_at = -float("inf")
        self._orders: set[asyncio.Task[None]] = set()

    def get_compression_options(self) -> dict[str, Any]:
        return {"compression_level": 6, "mem_level": 8}

    @property
    def max_message_size(self) -> int:
        return MAX_REQUEST

    def open(self, *_: str, **__: str) -> None:
        self._viewer = self._server.enter(self)
        if self._viewer is None:
            self.close(1013, f"{MAX_VIEWERS} viewers look already; close one")

    def on_close(self) -> None:
        self._server.leave(self)

    async def on_message(self, message: str | bytes) -> None:
        """{"maps": [[robot, kind]]}: the maps that are looked at; {"past": s}: show what was at that time of the team's
        clock; {"command": ..., "robot": ..., "to": robot that it is to be passed on to, "limits": [s, m]
        of set_limits}: an order."""
        try:
            request = json.loads(message)
            if "maps" in request:
                self._look_at({(str(robot), str(kind)) for robot, kind in request["maps"]})
            elif "past" in request:
                await self._show_past(float(request["past"]))
            else:
                limits = tuple(float(limit) for limit in request.get("limits", ()))
                self._begin(str(request["robot"]), Order(str(request["command"]), str(request.get("to", "")), limits))
        except (ValueError, KeyError, TypeError, AttributeError):
            self.close(1007, "this is no request of a page")

    def _look_at(self, maps: set[tuple[str, str]]) -> None:
        if self._viewer is not None:
            self._viewer.wants = lambda robot, kind: (robot, kind) in maps

    async def _show_past(self, time: float) -> None:
        if self._viewer is None:
            return
        update = self._server.past(time, self._viewer)
        with contextlib.suppress(WebSocketClosedError):
            await self.write_message(encoded(update or Update(moment=(None, time))), binary=True)

    def _begin(self, robot: str, order: Order) -> None:
        """As a task: a robot may take seconds to answer, and what the viewer says meanwhile is to be heard."""
        task = asyncio.create_task(self._order(robot, order, len(self._orders) < MAX_ORDERS))
        self._orders.add(task)
        task.add_done_callback(self._orders.discard)

    async def _order(self, robot: str, order: Order, is_taken: bool) -> None:
        late = Answer(False, f"{MAX_ORDERS} orders wait for their answers; wait for one")
        answer = await self._server.order(robot, order) if is_taken else late
        told = {"robot": robot, "command": order.command, "to": order.to, "done": answer.done, "text": answer.text}
        with contextlib.suppress(WebSocketClosedError):
            await self.write_message(told)

    def tell(self) -> None:
        """Send what is new, unless the last update is still on its way. Nothing new is told, too, now and then: a page
        knows by it that its connection is alive."""
        if self._viewer is None or self._busy:
            return
        now = IOLoop.current().time()
        update = self._viewer.update(now)
        if update is None and now - self._told_at >= QUIET:
            update = Update()
        if update is not None:
            self._busy = True
            self._told_at = now
            IOLoop.current().add_callback(self._send, encoded(update))

    async def _send(self, message: bytes) -> None:
        try:
            await self.write_message(message, binary=True)
        except WebSocketClosedError:
            return
        finally:
            self._busy = False


def is_own_name(host: str) -> bool:
    """Whether the Host of a request is this computer by address or name: whoever resolves a name of his own to it
    (DNS rebinding) sends that name."""
    name = host.rsplit(":", 1)[0] if host.count(":") == 1 or "]" in host else host
    name = name.strip("[]").lower()
    own = socket.gethostname().lower()
    if name in ("localhost", own, own.split(".")[0], own.split(".")[0] + ".local"):
        return True
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def listening_sockets(port: int, address: str) -> list[socket.socket]:
    """OSError with a sentence when that cannot be had."""
    try:
        return bind_sockets(port, address)
    except OSError as error:
        raise OSError(f"no page at {address}, port {port}: {error.strerror or error}; give another port") from None


def quiet_logs() -> None:
    """One line for each request is no news."""
    logging.getLogger("tornado.access").setLevel(logging.ERROR)
