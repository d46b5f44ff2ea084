"""Part of a robot's bags as one bag to play: a stretch of time, without what is computed again."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any, Callable, Collection

from mr_launch.recordings.bags import SECOND, Span, latched, messages, topic_of

CLOCK = ("/clock", "rosgraph_msgs/msg/Clock", "time clock\n", "a9c97c1d230cfc112e270351a944ee47")
NAVIGATION = "move_base/"  # topics of the action, whose goals the explorer gives
EXPLORER = "explorer"


def is_played(compute: Collection[str]) -> Callable[[Any], bool]:
    """Says of a connection whether it is played back: not what the nodes `compute` published, nor what became of their
    goals. The time comes from the player."""

    def played(connection: Any) -> bool:
        topic, node = topic_of(connection), str(connection.ext.callerid or "").strip("/")
        if topic == "clock" or node in compute:
            return False
        return not (EXPLORER in compute and topic.startswith(NAVIGATION))

    return played


def cut(reader: Any, target: Path, span: Span, played: Callable[[Any], bool]) -> None:
    """Writes the messages within `span`. It begins, however late the robot's bags do, at the start of the span with the
    time and with what latched topics held then."""
    from rosbags.rosbag1 import Writer

    connections = [connection for connection in reader.connections if played(connection)]
    held = {}
    if span.start > reader.start_time:
        kept = [connection for connection in connections if latched(connection)]
        for connection, _, octets in messages(reader, kept, stop=span.start):
            held[topic_of(connection), connection.ext.callerid] = (connection, octets)
    with Writer(target) as writer:
        clock = writer.add_connection(*CLOCK[:2], msgdef=CLOCK[2], md5sum=CLOCK[3])
        writer.write(clock, span.start, struct.pack("<II", *divmod(span.start, SECOND)))
        copies = _Copies(writer)
        for connection, octets in held.values():
            copies.write(connection, span.start, octets)
        for connection, time, octets in messages(reader, connections, span.start, span.end + 1):
            copies.write(connection, time, octets)


class _Copies:
    """Connections of several bags that say the same are one."""

    def __init__(self, writer: Any) -> None:
        self._writer = writer
        self._connections: dict[tuple[Any, ...], Any] = {}

    def write(self, source: Any, time: int, octets: bytes) -> None:
        key = (source.topic, source.digest, source.ext)
        if key not in self._connections:
            self._connections[key] = self._writer.add_connection(
                source.topic,
                source.msgtype,
                msgdef=source.msgdef.data,
                md5sum=source.digest,
                callerid=source.ext.callerid,
                latching=source.ext.latching,
            )
        self._writer.write(self._connections[key], time, octets)
