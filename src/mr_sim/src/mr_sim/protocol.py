"""What the world process and its robots say to each other over a Unix SEQPACKET socket.

One packet is one message: a byte that tells its kind, then little-endian fields. SI units, angles in radians.

| Kind | From | Fields |
| --- | --- | --- |
| `H` hello | robot | version u8, robot name (UTF-8): the first packet of a connection |
| `C` command | robot | linear f64, lateral f64, angular f64: wanted velocity |
| `W` welcome | world | version u8, interval f64, start pose 3 f64, number of rangers u8, then per ranger: mount 3 f64, range_min f64, range_max f64, angle_min f64, angle_increment f64, samples u32, update_interval f64 |
| `S` state | world | time f64, odometry pose 3 f64, wheel velocities (ahead, to the left, turn) 3 f64, true pose 3 f64, true velocity in the world frame 3 f64, stalled u8, contact u8 (0 none, 1 wall, 2 robot): at each base update |
| `I` intensities | world | ranger u8, f32 per sample: before the ranges of the same sweep, if the world tells them |
| `R` ranges | world | ranger u8, time f64, then f32 per sample: after the state of the same time |
| `E` refusal | world | reason (UTF-8); the world closes the connection |
| `B` bye | world | nothing: the world ends in an orderly way |

The world starts to move when all its robots have said hello. A robot whose connection ends stops; it may connect again
and goes on from where it stands. A robot that does not read for 10 s is taken for dead; until then the world waits.
"""  # noqa: E501

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

VERSION = 2
MAX_PACKET = 1 << 17
MAX_NAME = 64

_COMMAND = struct.Struct("<c3d")
_WELCOME = struct.Struct("<cBd3dB")
_RANGER = struct.Struct("<3d4dId")
_STATE = struct.Struct("<cd3d3d3d3dBB")
_RANGES = struct.Struct("<cBd")


class ProtocolError(ValueError):
    """A packet that is not of this protocol."""


@dataclass(frozen=True)
class Hello:
    name: str


@dataclass(frozen=True)
class Command:
    linear: float
    lateral: float
    angular: float


@dataclass(frozen=True)
class RangerInfo:
    mount: tuple[float, float, float]
    range_min: float
    range_max: float
    angle_min: float
    angle_increment: float
    samples: int
    update_interval: float


@dataclass(frozen=True)
class Welcome:
    interval: float
    start: tuple[float, float, float]
    rangers: tuple[RangerInfo, ...]


@dataclass(frozen=True)
class State:
    time: float
    odometry: tuple[float, float, float]
    wheels: tuple[float, float, float]
    pose: tuple[float, float, float]
    velocity: tuple[float, float, float]
    stalled: bool
    contact: int


@dataclass(frozen=True)
class Intensities:
    """Of the ranges that follow."""

    ranger: int
    intensities: np.ndarray  # float32 (samples,)


@dataclass(frozen=True)
class Ranges:
    ranger: int
    time: float
    ranges: np.ndarray  # float32 (samples,)


@dataclass(frozen=True)
class Refusal:
    reason: str


@dataclass(frozen=True)
class Bye:
    pass


Message = Hello | Command | Welcome | State | Intensities | Ranges | Refusal | Bye


def encode_hello(name: str) -> bytes:
    return b"H" + bytes([VERSION]) + name.encode()


def encode_command(linear: float, lateral: float, angular: float) -> bytes:
    return _COMMAND.pack(b"C", linear, lateral, angular)


def encode_welcome(welcome: Welcome) -> bytes:
    packet = _WELCOME.pack(b"W", VERSION, welcome.interval, *welcome.start, len(welcome.rangers))
    for r in welcome.rangers:
        packet += _RANGER.pack(
            *r.mount, r.range_min, r.range_max, r.angle_min, r.angle_increment, r.samples, r.update_interval
        )
    return packet


def encode_state(time: float, record: np.void) -> bytes:
    """`record`: one element of `World.states()`."""
    return _STATE.pack(b"S", time, *record.item())


def encode_intensities(ranger: int, intensities: np.ndarray) -> bytes:
    return bytes([ord("I"), ranger]) + intensities.tobytes()


def encode_ranges(ranger: int, time: float, ranges: np.ndarray) -> bytes:
    return _RANGES.pack(b"R", ranger, time) + ranges.tobytes()


def encode_refusal(reason: str) -> bytes:
    return b"E" + reason.encode()


def encode_bye() -> bytes:
    return b"B"


def decode(packet: bytes) -> Message:
    """Message in a packet; raises ProtocolError when it is not one."""
    decoder = _DECODERS.get(packet[:1])
    if decoder is None:
        raise ProtocolError(f"unknown kind of message {packet[:1]!r}")
    try:
        return decoder(packet)
    except (struct.error, UnicodeDecodeError) as error:
        raise ProtocolError(f"malformed message {packet[:1]!r} of {len(packet)} bytes") from error


def _decode_hello(packet: bytes) -> Hello:
    if len(packet) < 3 or len(packet) > 2 + 4 * MAX_NAME:
        raise ProtocolError("hello without a robot name")
    if packet[1] != VERSION:
        raise ProtocolError(f"protocol version {packet[1]}, this world speaks version {VERSION}")
    return Hello(packet[2:].decode())


def _decode_command(packet: bytes) -> Command:
    _, linear, lateral, angular = _COMMAND.unpack(packet)
    if not all(map(math.isfinite, (linear, lateral, angular))):
        raise ProtocolError("a velocity command must be finite")
    return Command(linear, lateral, angular)


def _decode_welcome(packet: bytes) -> Welcome:
    _, version, interval, x, y, yaw, count = _WELCOME.unpack_from(packet)
    if version != VERSION:
        raise ProtocolError(f"the world speaks protocol version {version}, this robot version {VERSION}")
    if len(packet) != _WELCOME.size + count * _RANGER.size:
        raise ProtocolError("welcome of wrong length")
    rangers = []
    for index in range(count):
        fields = _RANGER.unpack_from(packet, _WELCOME.size + index * _RANGER.size)
        rangers.append(RangerInfo((fields[0], fields[1], fields[2]), *fields[3:]))
    return Welcome(interval, (x, y, yaw), tuple(rangers))


def _decode_state(packet: bytes) -> State:
    _, time, ox, oy, oyaw, linear, lateral, angular, x, y, yaw, vx, vy, vyaw, stalled, contact = _STATE.unpack(packet)
    return State(time, (ox, oy, oyaw), (linear, lateral, angular), (x, y, yaw), (vx, vy, vyaw), bool(stalled), contact)


def _decode_intensities(packet: bytes) -> Intensities:
    if len(packet) < 2 or len(packet) % 4 != 2:
        raise ProtocolError("intensities of broken length")
    return Intensities(packet[1], np.frombuffer(packet, dtype="<f4", offset=2))


def _decode_ranges(packet: bytes) -> Ranges:
    _, ranger, time = _RANGES.unpack_from(packet)
    if (len(packet) - _RANGES.size) % 4:
        raise ProtocolError("ranges of broken length")
    return Ranges(ranger, time, np.frombuffer(packet, dtype="<f4", offset=_RANGES.size))


_DECODERS: dict[bytes, Callable[[bytes], Message]] = {
    b"H": _decode_hello,
    b"C": _decode_command,
    b"W": _decode_welcome,
    b"S": _decode_state,
    b"I": _decode_intensities,
    b"R": _decode_ranges,
    b"E": lambda packet: Refusal(packet[1:].decode()),
    b"B": lambda packet: Bye(),
}
