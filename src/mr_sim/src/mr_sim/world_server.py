"""The world on a Unix socket: lets the engine's time follow the clock and speaks `protocol` with the robots."""

import contextlib
import os
import selectors
import signal
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from mr_sim import protocol
from mr_sim.radio_control import RadioControl
from mr_sim.trace import TraceWriter
from mr_sim.world import World, WorldError

HELLO_PATIENCE = 5.0  # s a connection may take to name its robot
CLIENT_PATIENCE = 10.0  # s the world waits for a robot that does not read
MAX_LAG = 0.25  # s behind the clock that are still caught up; what exceeds it is lost, so time slows and never jumps
SPARE_CONNECTIONS = 64  # of others than the robots, who are refused before long
MAX_SOCKET_PATH = 107


class ServerError(RuntimeError):
    """The world cannot be offered as asked."""


@dataclass
class _Client:
    socket: socket.socket
    connected_at: float
    robot: int | None = None


def listen(path: str) -> socket.socket:
    """A listening SEQPACKET socket at `path`; replaces one that a dead process left behind. Raises ServerError."""
    if len(path.encode()) > MAX_SOCKET_PATH:
        raise ServerError(f"socket path longer than {MAX_SOCKET_PATH} bytes: {path}")
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET | socket.SOCK_NONBLOCK)
    try:
        if Path(path).is_socket():
            with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as probe:
                if probe.connect_ex(path) == 0:
                    raise ServerError(f"another world listens on {path}: stop it or choose another --socket")
            os.unlink(path)
        listener.bind(path)
        listener.listen(SPARE_CONNECTIONS)
    except OSError as error:
        listener.close()
        raise ServerError(f"cannot listen on {path}: {error.strerror}") from error
    return listener


class WorldServer:
    """Runs a world for its robots.

    Args:
        world: the engine.
        listener: from `listen`.
        real_time_factor: simulated seconds per second; <= 0: as fast as the robots read.
        duration: simulated seconds after which the run ends, None: until stopped.
        say: receives one line per event worth a person's attention.
    """

    def __init__(
        self,
        world: World,
        listener: socket.socket,
        real_time_factor: float = 1.0,
        duration: float | None = None,
        trace: TraceWriter | None = None,
        radio: RadioControl | None = None,
        say: Callable[[str], None] = print,
    ) -> None:
        self.world = world
        self.wall = 0.0  # s since the world began to move
        self._listener = listener
        self._factor = real_time_factor
        self._duration = duration
        self._trace = trace
        self._radio = radio
        self._say = say
        self._stop = False
        self._reset = False
        self._clients: dict[int, _Client] = {}
        self._of_robot: list[_Client | None] = [None] * len(world.names)
        self._selector = selectors.DefaultSelector()
        self._selector.register(listener, selectors.EVENT_READ)
        self._wake_reader, self._wake_writer = socket.socketpair()
        self._wake_reader.setblocking(False)
        self._wake_writer.setblocking(False)
        self._selector.register(self._wake_reader, selectors.EVENT_READ)

    @property
    def achieved_factor(self) -> float:
        return self.world.time / self.wall if self.wall > 0.0 else 0.0

    def stop(self, *_: object) -> None:
        """End the run soon; may be called from a signal handler or another thread."""
        self._stop = True
        with contextlib.suppress(OSError):
            self._wake_writer.send(b"x")

    def reset_positions(self) -> None:
        """Robots stand at their start poses before the next step; may be called from another thread."""
        self._reset = True

    def stop_on_signals(self) -> None:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self.stop)

    def run(self) -> None:
        """Wait for all robots, then advance until stopped or the duration is over."""
        try:
            self._tell_radio()
            while not self._stop and None in self._of_robot:
                self._handle_ready(timeout=1.0)
            self._advance()
        finally:
            self._close()

    def _advance(self) -> None:
        start = due = time.monotonic()
        period = self.world.interval / self._factor if self._factor > 0.0 else 0.0
        while not self._stop and (self._duration is None or self.world.time < self._duration - 1e-9):
            due = max(due + period, time.monotonic() - MAX_LAG)
            self._serve(due)
            if self._stop:
                break
            if self._reset:
                self._reset = False
                self.world.reset_positions()
            self.world.step()
            self.wall = time.monotonic() - start
            self._publish()

    # --- towards the robots ---

    def _publish(self) -> None:
        now, states = self.world.time, self.world.states()
        for robot, name in enumerate(self.world.names):
            if self.world.base_due(robot):
                self._send(robot, protocol.encode_state(now, states[robot]))
                if self._trace:
                    self._trace.write(now, self.wall, name, states[robot])
        for scan in self.world.due_scans():
            if scan.intensities is not None:
                self._send(scan.robot, protocol.encode_intensities(scan.ranger, scan.intensities))
            self._send(scan.robot, protocol.encode_ranges(scan.ranger, now, scan.ranges))
        self._tell_radio()

    def _tell_radio(self) -> None:
        if self._radio:
            self._radio.update(self.world.time, time.monotonic(), self.world.names, self.world.states())

    def _send(self, robot: int, packet: bytes) -> None:
        client = self._of_robot[robot]
        if client is None:
            return
        try:
            client.socket.send(packet)
        except BlockingIOError:
            self._send_patiently(client, packet)
        except OSError:
            self._drop(client, "connection lost")

    def _send_patiently(self, client: _Client, packet: bytes) -> None:
        """The robot's queue is full: time stands still until it reads, so no message is skipped."""
        client.socket.settimeout(CLIENT_PATIENCE)
        try:
            client.socket.send(packet)
            client.socket.setblocking(False)
        except OSError:
            self._drop(client, f"did not read for {CLIENT_PATIENCE:g} s")

    # --- from the robots ---

    def _serve(self, until: float) -> None:
        """Handle what robots send until the monotonic time `until`, at least once."""
        while True:
            self._handle_ready(max(0.0, until - time.monotonic()))
            if self._stop or time.monotonic() >= until:
                return

    def _handle_ready(self, timeout: float) -> None:
        ready = {key.fd: key.fileobj for key, _ in self._selector.select(timeout)}
        if self._wake_reader in ready.values():
            self._wake_reader.recv(64)
        for client in [self._clients[fd] for fd in ready if fd in self._clients]:
            self._receive(client)
        if self._listener in ready.values():  # last: connections that have ended make room for new ones
            self._accept()
        self._expire_silent()

    def _accept(self) -> None:
        try:
            connection, _ = self._listener.accept()
        except OSError:
            return
        connection.setblocking(False)
        client = _Client(connection, time.monotonic())
        self._clients[connection.fileno()] = client
        self._selector.register(connection, selectors.EVENT_READ)
        if len(self._clients) > len(self.world.names) + SPARE_CONNECTIONS:
            self._refuse(client, "too many connections")

    def _receive(self, client: _Client) -> None:
        try:
            packet = client.socket.recv(protocol.MAX_PACKET)
        except BlockingIOError:
            return
        except OSError:
            packet = b""
        if not packet:
            self._drop(client, "connection closed")
            return
        try:
            self._handle(client, protocol.decode(packet))
        except (protocol.ProtocolError, WorldError) as error:
            self._refuse(client, str(error))

    def _handle(self, client: _Client, message: protocol.Message) -> None:
        if isinstance(message, protocol.Hello) and client.robot is None:
            self._welcome(client, message.name)
        elif isinstance(message, protocol.Command) and client.robot is not None:
            self.world.command(client.robot, message.linear, message.angular, message.lateral)
        else:
            raise protocol.ProtocolError(f"a robot may not send {type(message).__name__} now")

    def _welcome(self, client: _Client, name: str) -> None:
        robot = self.world.index(name)
        if self._of_robot[robot] is not None:
            raise WorldError(f"{name} is connected already: give each robot its own name")
        client.robot = robot
        self._of_robot[robot] = client
        description = self.world.robots[robot]
        rangers = tuple(
            protocol.RangerInfo(
                r.mount, r.range_min, r.range_max, r.angle_min, r.angle_increment, r.samples, r.update_interval
            )
            for r in description.rangers
        )
        self._send(robot, protocol.encode_welcome(protocol.Welcome(self.world.interval, description.start, rangers)))
        waiting = [n for n, c in zip(self.world.names, self._of_robot, strict=True) if c is None]
        self._say(f"{name} connected" + (f", waiting for {', '.join(waiting)}" if waiting else ""))

    # --- connections that end ---

    def _expire_silent(self) -> None:
        now = time.monotonic()
        for client in list(self._clients.values()):
            if client.robot is None and now - client.connected_at > HELLO_PATIENCE:
                self._refuse(client, "no hello")

    def _refuse(self, client: _Client, reason: str) -> None:
        with contextlib.suppress(OSError):
            client.socket.send(protocol.encode_refusal(reason))
            client.socket.shutdown(socket.SHUT_RD)
            while client.socket.recv(protocol.MAX_PACKET):  # what is left unread would reset the peer before it reads
                pass
        self._drop(client, reason)

    def _drop(self, client: _Client, reason: str) -> None:
        if client.robot is None:
            self._say(f"connection refused: {reason}")
        else:
            name = self.world.names[client.robot]
            self._of_robot[client.robot] = None
            self.world.command(client.robot, 0.0, 0.0)
            self._say(f"{name} is gone ({reason}); it stands still and the world goes on")
        self._selector.unregister(client.socket)
        del self._clients[client.socket.fileno()]
        client.socket.close()

    def _close(self) -> None:
        for client in self._clients.values():
            with contextlib.suppress(OSError):
                client.socket.send(protocol.encode_bye())
            client.socket.close()
        self._clients.clear()
        if self._trace:
            self._trace.close(self.world.time, self.wall)
        if self._radio:
            self._radio.close()
        self._selector.close()
        self._wake_reader.close()
        self._wake_writer.close()
        path = self._listener.getsockname()
        self._listener.close()
        with contextlib.suppress(OSError):
            os.unlink(path)
