"""Client side of the world socket, for the robot node and for tests. No ROS."""

import contextlib
import socket
import time

from mr_sim import protocol


class ConnectionRefused(RuntimeError):
    """The world is not there or does not take this robot."""


class WorldClient:
    """One robot's connection to the world process."""

    def __init__(self, connection: socket.socket, welcome: protocol.Welcome) -> None:
        self._socket = connection
        self.welcome = welcome

    @classmethod
    def connect(cls, path: str, name: str, timeout: float) -> "WorldClient":
        """Connect as robot `name`, trying for `timeout` seconds while nobody listens. Raises ConnectionRefused."""
        deadline = time.monotonic() + timeout
        while True:
            connection = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            try:
                connection.connect(path)
                connection.settimeout(max(1.0, timeout))
                with contextlib.suppress(BrokenPipeError):  # refused unasked: the reason can be read
                    connection.send(protocol.encode_hello(name))
                answer = protocol.decode(connection.recv(protocol.MAX_PACKET))
                break
            except (FileNotFoundError, ConnectionRefusedError) as error:
                connection.close()
                if time.monotonic() >= deadline:
                    raise ConnectionRefused(f"no world listens on {path}: {error.strerror}") from error
                time.sleep(0.1)
            except (OSError, protocol.ProtocolError) as error:
                connection.close()
                raise ConnectionRefused(f"the world on {path} does not answer: {error}") from error
        if not isinstance(answer, protocol.Welcome):
            connection.close()
            reason = answer.reason if isinstance(answer, protocol.Refusal) else "it does not speak the protocol"
            raise ConnectionRefused(f"the world on {path} refuses {name}: {reason}")
        connection.settimeout(None)
        return cls(connection, answer)

    def receive(self) -> protocol.Message | None:
        """The next message; None when the connection has ended. Blocks."""
        try:
            packet = self._socket.recv(protocol.MAX_PACKET)
        except OSError:
            return None
        return protocol.decode(packet) if packet else None

    def command(self, linear: float, angular: float, lateral: float = 0.0) -> None:
        """Send a wanted velocity; a lost connection shows in `receive`."""
        with contextlib.suppress(OSError):
            self._socket.send(protocol.encode_command(linear, lateral, angular))

    def close(self) -> None:
        """Ends a blocked `receive` as well."""
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()
