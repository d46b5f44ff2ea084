"""Captures of the radio in pcap format."""

import struct
from pathlib import Path
from typing import Iterator, NamedTuple


class Captured(NamedTuple):
    destination: bytes
    source: bytes
    octets: bytes


def capture(path: Path) -> Iterator[Captured]:
    """The frames of a capture in pcap format."""
    octets = path.read_bytes()
    at = 24
    while at < len(octets):
        (size,) = struct.unpack_from("=I", octets, at + 8)
        frame = octets[at + 16 : at + 16 + size]
        assert frame[12:14] == b"\x88\xb5"
        yield Captured(frame[:6], frame[6:12], frame[14:])
        at += 16 + size
