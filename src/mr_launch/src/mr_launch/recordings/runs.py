"""What the runs of a robot were called then."""

from __future__ import annotations

from typing import Any

from mr_launch.recordings.bags import Span, decoded, messages, topic_of

GLOBAL_MAP = "map_merger/global_map"


def run_of_merger(reader: Any, span: Span) -> str:
    """Of map_merger's first run within `span`, as its parameter `run`; empty if the bags do not tell. In transforms
    others name the run of whose frame they speak, and to another run they say nothing."""
    drawn = [connection for connection in reader.connections if topic_of(connection) == GLOBAL_MAP]
    for connection, _, octets in messages(reader, drawn, span.start, span.end + 1):
        message = decoded(reader, connection, octets)
        begun = None if message is None else message.info.map_load_time
        if begun is not None and (begun.sec, begun.nanosec) != (0, 0):
            return f"{begun.sec}.{begun.nanosec:09d}"
    return ""
