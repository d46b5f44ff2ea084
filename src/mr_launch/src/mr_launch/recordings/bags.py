"""Bags of ROS 1, read by rosbags, which needs no ROS."""

from __future__ import annotations

import struct
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Iterator, NamedTuple, Sequence

from mr_launch.errors import UserError

SECOND = 10**9  # ns
LONGEST_MISSION = 86400 * SECOND
UNDECODABLE = (ValueError, IndexError, struct.error)  # of rosbags, beside its own


class Span(NamedTuple):
    """From the first message to the last, ns on the robot's own clock."""

    start: int
    end: int


def topic_of(connection: Any) -> str:
    """Name without a leading slash, as a recorder's relative names have none."""
    return str(connection.topic).lstrip("/")


def latched(connection: Any) -> bool:
    return bool(connection.ext.latching)


@contextmanager
def opened(paths: Sequence[Path]) -> Iterator[Any]:
    """The bags of one robot as one reader. Raises UserError for what is no finished bag."""
    try:
        from rosbags.highlevel import AnyReader, AnyReaderError
    except ImportError:
        raise UserError(
            "the Python package rosbags is missing: run tools/install_dependencies, then source tools/environment.sh"
        ) from None
    for path in paths:
        _check(path)
    try:
        reader = AnyReader(list(paths))
        reader.open()
    except (AnyReaderError, OSError, AssertionError) as error:
        raise UserError(f"{_names(paths)} cannot be read: {error}; 'rosbag reindex' may mend it") from None
    try:
        yield reader
    finally:
        reader.close()


def span_of(reader: Any) -> Span:
    return Span(int(reader.start_time), int(reader.end_time) - 1)  # rosbags counts 1 ns more


def messages(
    reader: Any, connections: Sequence[Any], start: int | None = None, stop: int | None = None
) -> Iterator[tuple[Any, int, bytes]]:
    """Connection, time in ns and octets, in the order of time, from `start` and before `stop`. Nothing for no
    connections."""
    if connections:
        yield from reader.messages(connections=connections, start=start, stop=stop)


def pause_between_clocks(reader: Any, span: Span) -> Span | None:
    """Within `span`: the longest from a message of any topic to the next one, before the first, or after the last, if
    no mission lasts that long. A recorder that began before time was simulated writes the times of two clocks into one
    bag: decades lie between."""
    if length_of(span) <= LONGEST_MISSION:
        return None
    longest, before = Span(span.start, span.start), span.start
    for _, time, _ in messages(reader, reader.connections, span.start, span.end):
        longest = max(longest, Span(before, time), key=length_of)
        before = time
    longest = max(longest, Span(before, span.end), key=length_of)
    return longest if length_of(longest) > LONGEST_MISSION else None


def length_of(span: Span) -> int:
    """In ns."""
    return span.end - span.start


def decoded(reader: Any, connection: Any, octets: bytes) -> Any:
    """The message, or None for octets that are none of its type."""
    from rosbags.serde import SerdeError

    try:
        return reader.typestore.deserialize_ros1(octets, connection.msgtype)
    except (*UNDECODABLE, SerdeError):
        return None


def place_of(connection: Any) -> tuple[str, str]:
    """Bag and topic."""
    return str(connection.owner.path), topic_of(connection)


def _check(path: Path) -> None:
    if path.suffix == ".active":
        mend = f"'rosbag reindex {path}', then rename it to {path.stem}"
        raise UserError(f"{path} was not closed: wait until its mission is over; if a crash left it so, {mend}")
    try:
        with path.open("rb") as file:
            if not file.read(13).startswith(b"#ROSBAG V2.0"):
                raise UserError(f"{path} is no bag of ROS 1")
    except OSError as error:
        raise UserError(f"{path} cannot be read: {error.strerror}") from None


def _names(paths: Sequence[Path]) -> str:
    return ", ".join(map(str, paths))
