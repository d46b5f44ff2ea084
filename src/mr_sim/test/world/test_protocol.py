"""The language of the world socket."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mr_sim import protocol as p

LASER = p.RangerInfo((0.1, 0.0, 0.0), 0.0, 8.0, -2.0, 0.01, 401, 0.1)
SONAR = p.RangerInfo((0.0, 0.0, 0.0), 0.1, 4.0, 0.0, 0.0, 1, 0.2)
WELCOME = p.Welcome(0.05, (1.0, 2.0, 0.5), (LASER, SONAR))


def test_what_is_encoded_is_decoded(make_world):
    world = make_world('rover ( name "a" pose [ 1 2 0 30 ] )')
    world.command(0, 0.3, 0.2)
    world.step()
    assert p.decode(p.encode_hello("robot_0")) == p.Hello("robot_0")
    assert p.decode(p.encode_command(0.25, 0.5, -1.5)) == p.Command(0.25, 0.5, -1.5)
    assert p.decode(p.encode_welcome(WELCOME)) == WELCOME
    assert p.decode(p.encode_refusal("no such robot")) == p.Refusal("no such robot")
    assert p.decode(p.encode_bye()) == p.Bye()
    state = p.decode(p.encode_state(world.time, world.states()[0]))
    assert (state.time, state.pose, state.wheels) == (0.05, world.pose(0), (0.3, 0.0, 0.2))
    assert (state.stalled, state.contact) == (False, 0)
    ranges = world.core.scan(0, 0)
    decoded = p.decode(p.encode_ranges(0, world.time, ranges))
    assert decoded.ranger == 0 and decoded.time == 0.05
    assert np.array_equal(decoded.ranges, ranges) and decoded.ranges.dtype == np.float32
    told = p.decode(p.encode_intensities(3, ranges))
    assert told.ranger == 3 and np.array_equal(told.intensities, ranges) and told.intensities.dtype == np.float32


@pytest.mark.parametrize(
    "packet",
    [
        b"", b"?", b"H", b"H\x02", b"H\x01robot_0", b"H\x02\xff\xfe", b"H\x02" + b"x" * 1000, b"C", b"C" + bytes(15),
        p.encode_command(float("nan"), 0.0, 0.0), p.encode_command(0.0, float("nan"), 0.0),
        p.encode_command(0.0, 0.0, float("inf")), p.encode_welcome(WELCOME)[:-1],
        b"W\x09" + p.encode_welcome(WELCOME)[2:], b"S" + bytes(7), b"R\x00", b"I", b"I\x00\x00",
        p.encode_ranges(0, 0.0, np.zeros(2, "f4"))[:-1],
    ],
)  # fmt: skip
def test_malformed_packets_are_refused(packet):
    with pytest.raises(p.ProtocolError):
        p.decode(packet)


@given(packet=st.binary(max_size=200))
def test_any_packet_is_decoded_or_refused(packet):
    for kind in (b"", b"H", b"C", b"W", b"S", b"I", b"R", b"E", b"B"):
        try:
            p.decode(kind + packet)
        except p.ProtocolError as error:
            assert str(error)
