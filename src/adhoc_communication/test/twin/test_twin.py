"""An implementation of docs/protocol.md in Python and the engine understand each other."""

import json
import random
import subprocess
import sys
import zlib
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import frames
from captures import capture
from group import GroupPacket, digest
from namespaces import program
from robot import BEACON, DATA, HOP_ACKNOWLEDGMENT, REPLY, REQUEST

from air import Air, address, name

VECTORS = json.loads((frames.DOCUMENT.parent / "protocol_vectors.json").read_text(encoding="utf-8"))
KEY = bytes.fromhex(VECTORS["team_key"])
KEYS = pytest.mark.parametrize("key", [None, KEY], ids=["open", "sealed"])


def noise(size, seed=1):
    return random.Random(seed).getrandbits(8 * size).to_bytes(size, "big")


def as_json(value):
    """Fields as the file has them: octets in hexadecimal digits."""
    if isinstance(value, dict):
        return {str(key): as_json(item) for key, item in value.items()}
    if isinstance(value, list):
        return [as_json(item) for item in value]
    return value.hex() if isinstance(value, bytes) else value


def octets_of(example, key):
    return bytes.fromhex(example["open" if key is None else "sealed"])


def by_name(examples, wanted):
    return next(example for example in examples if example["name"] == wanted)


# The examples.


@KEYS
@pytest.mark.parametrize("example", VECTORS["frames"], ids=lambda example: example["name"])
def test_an_example_is_read_and_written(example, key):
    header, fields = frames.open_frame(octets_of(example, key), key)
    assert as_json(fields) == example["fields"]
    header["flags"] &= ~frames.SEALED
    assert as_json(header) == {"version": VECTORS["version"], **example["header"]}
    assert frames.close(header, fields, key) == octets_of(example, key)


def test_there_is_an_example_of_each_type():
    assert {example["header"]["type"] for example in VECTORS["frames"]} == set(range(1, 16)) == set(frames.BODIES)


@KEYS
def test_what_is_cut_or_altered_is_refused(key):
    for example in VECTORS["frames"]:
        octets = octets_of(example, key)
        altered = [octets[:i] + bytes([octets[i] ^ 4]) + octets[i + 1 :] for i in range(len(octets))]
        for wrong in altered + [octets[:i] for i in range(len(octets))]:
            with pytest.raises(frames.Malformed):
                frames.open_frame(wrong, key)


def at_the_bounds(row):
    """Values that are just allowed, or just not, of a field of the tables."""
    _, kind, allowed, _ = row
    if allowed.startswith("bits"):
        return [1 << bit for bit in range(8)]
    if not allowed:
        return []
    least, most = map(int, allowed.split(" to "))
    values = {least - 1, least, most, most + 1} - {-1}
    if kind[0] == "u":
        return sorted(value for value in values if value < 2 ** int(kind[1:]))
    receipt = {"root": address(5), "root_boot_tag": bytes(8), "stream": 1, "member": address(6), "next": 3, "beyond": 1}
    item = {"address": address(5), "sequence": 1, **receipt}
    return [
        [item] * value if kind == "list" else bytes(value) for value in sorted(values) if value < 256 or kind != "list"
    ]


def cases():
    """Names of examples, and fields of theirs with other values."""
    for example in VECTORS["frames"]:
        for row in frames.BODIES[example["header"]["type"]]:
            for value in at_the_bounds(row):
                yield example["name"], {row[0]: value}
    for example_name, field, *values in (
        ("beacon", "name", "", "two words", "a" * 65, "a" * 64, "\x7f"),
        ("beacon", "extensions", {127: b"x"}, {128: b"x"}, {0: b""}),
        ("route request", "originator", frames.EVERYBODY, frames.NOBODY, bytes([3, 0, 0, 0, 0, 1])),
        ("route request", "destination", frames.EVERYBODY, frames.NOBODY),
        ("route request", "destination_name", "", "two words"),
        ("route request by name", "destination_name", ""),
        ("route reply", "originator", frames.EVERYBODY, frames.NOBODY),
        ("data", "segment_size", 63, 65),
        ("data", "octets", bytes(63), bytes(65)),
        ("data", "index", 1, 2, 3),
        ("data, last segment", "total", 129, 131),
        ("broadcast data", "total", 127, 128),
        ("flood", "source_name", "", "two words"),
        ("group data", "octets", bytes(64), bytes(65)),
        ("group data, question", "stream", 1),
        ("group data, flooded", "total", 29, 30, 31),
        ("group data, flooded", "block", 0, 1),
        ("group data, flooded", "symbol", 0, 1),
    ):
        for value in values:
            yield example_name, {field: value}


LONGER_THAN_ANY = 4000  # octets, so that no frame is lost for its length before it is judged


class Judges:
    """Both implementations, which hear the same frame from a robot."""

    def __init__(self):
        self.air = Air("et", mtu=LONGER_THAN_ANY)
        self.air.run(1.0)

    def verdicts(self, kind, body):
        """Of the engine and of the twin: whether that is a body of this type."""
        twin = self.air.twins[1]
        header = {"version": 2, "type": kind, "flags": 0, "sender": address(1), "boot_id": twin.boot_id,
                  "counter": twin.counter, "next_hop": frames.EVERYBODY, "link_sequence": 0}  # fmt: skip
        twin.counter += 1
        octets = frames.write(frames.HEADER, header) + body
        octets += zlib.crc32(octets).to_bytes(4, "big")
        before = self.air.bridge.dropped(0)["malformed"]
        self.air.bridge.transmit(self.air.stations[1], frames.EVERYBODY, octets)
        self.air.run(0.003)
        try:
            frames.open_frame(octets)
            twin_takes_it = True
        except frames.Malformed:
            twin_takes_it = False
        return self.air.bridge.dropped(0)["malformed"] == before, twin_takes_it


def test_both_refuse_what_the_tables_do_not_allow_and_nothing_else():
    judges, seen = Judges(), set()
    for name_of_example, changes in cases():
        header, fields = frames.open_frame(octets_of(by_name(VECTORS["frames"], name_of_example), None))
        body = frames.write(frames.BODIES[header["type"]], {**fields, **changes})
        engine, twin = judges.verdicts(header["type"], body)
        assert engine == twin, (name_of_example, changes)
        seen.add(twin)
    assert seen == {True, False}


def test_both_refuse_the_same_of_what_is_changed_at_random():
    judges, generator, taken = Judges(), random.Random(1), 0
    # Packets that are put together from changed segments may be malformed as such.
    examples = [example for example in VECTORS["frames"] if example["header"]["type"] not in (8, 9, 12)]
    for _ in range(3000):
        example = generator.choice(examples)
        body = bytearray(octets_of(example, None)[43:-4])
        for _ in range(generator.randrange(1, 4)):
            place = generator.randrange(len(body) + 1)
            change = generator.choice([b"", b"\0", b"\1", b"\xff", bytes([generator.randrange(256)])])
            body[place : place + generator.choice([0, 1, 1, 1, 2])] = change
        engine, twin = judges.verdicts(example["header"]["type"], bytes(body))
        assert engine == twin, (example["name"], body.hex())
        taken += twin
    assert 500 < taken < 2500


@pytest.mark.parametrize("example", VECTORS["images"], ids=lambda example: example["name"])
def test_a_packet_is_read_and_written(example):
    image = frames.read_image(bytes.fromhex(example["octets"]))
    assert as_json(image) == example["fields"]
    if not image["flags"] & 1:
        assert frames.write(frames.IMAGE, image).hex() == example["octets"]


def test_payloads_of_groups():
    members = frames.Reader(bytes.fromhex(by_name(VECTORS["images"], "group members")["fields"]["payload"]))
    assert members.take(2) == b"\0\2"
    assert [members.one("name", []), members.one("name", []), members.octets] == ["alice", "bob", b""]
    copy = frames.Reader(bytes.fromhex(by_name(VECTORS["images"], "group copy")["fields"]["payload"]))
    assert [copy.one("u8", []), copy.one("u32", [])] == [1, 31]
    assert copy.octets.hex() == by_name(VECTORS["images"], "user")["octets"]


def test_key_of_a_run():
    header = VECTORS["frames"][0]["header"]
    key = frames.session_key(KEY, bytes.fromhex(header["sender"]), bytes.fromhex(header["boot_id"]))
    assert key.hex() == VECTORS["session_key"]


# What the document says of packets in groups.


def test_digests():
    for example in VECTORS["digests"]:
        assert digest(bytes.fromhex(example["address"])) == example["digest"]
    report = by_name(VECTORS["frames"], "group report")
    assert report["fields"]["coverage"] == digest(bytes.fromhex(report["header"]["sender"]))


def test_cut_into_blocks():
    for example in VECTORS["blocks"]:
        packet = GroupPacket(example["total"], example["segment_size"])
        assert [block.size for block in packet.blocks] == example["frames"]


def test_parity():
    code = VECTORS["erasure_code"]
    image = bytes.fromhex(code["image"])
    packet = GroupPacket(len(image), code["segment_size"], image)
    for parity in code["parity"]:
        assert packet.symbol(0, parity["symbol"]).hex() == parity["octets"]
    received = GroupPacket(len(image), code["segment_size"])
    received.blocks[0].take(4, packet.symbol(0, 4))
    received.blocks[0].take(1, packet.symbol(0, 1))
    for parity in code["parity"]:
        assert not received.complete()
        received.blocks[0].take(parity["symbol"], bytes.fromhex(parity["octets"]))
    assert received.image() == image


def test_a_capture_is_read(tmp_path):
    path = tmp_path / "sample.pcap"
    subprocess.run([program("sample_frames"), str(path)], check=True)
    *whole, sealed, altered, cut = capture(path)
    assert {frames.open_frame(frame.octets)[0]["type"] for frame in whole} == set(range(1, 16))
    for odd in (sealed, altered, cut):
        with pytest.raises(frames.Malformed):
            frames.open_frame(odd.octets)


# On the air.


@KEYS
@pytest.mark.parametrize("loss", [0.0, 0.1])
@pytest.mark.parametrize("row", ["te", "tee", "ete", "tet", "teee"])
def test_100_kB_go_both_ways(row, loss, key, tmp_path):
    last = len(row) - 1
    air = Air(row, key, loss, path=tmp_path / "air.pcap")
    there, back = noise(100_000), noise(50_000, 2) + bytes(50_000)  # the engine compresses what gets shorter
    air.run(1.0)
    air.send(0, last, there)
    air.send(last, 0, back)
    assert air.run(10.0, air.finished)
    air.run(1.0)
    assert air.received(last) == [(name(0), "topic", there, last)]
    assert air.received(0) == [(name(last), "topic", back, last)]
    assert all(twin.malformed == 0 for twin in air.twins.values())
    for engine in air.engines.values():
        dropped = air.bridge.dropped(engine)
        assert sum(dropped.values()) == dropped["unproven"]
    kinds = {header["type"] for header, _ in air.frames(tmp_path / "air.pcap", key)}
    assert {BEACON, HOP_ACKNOWLEDGMENT, DATA} <= kinds
    assert last == 1 or {REQUEST, REPLY} <= kinds


@KEYS
@pytest.mark.parametrize(("row", "asks", "asked"), [("tqq", 0, 2), ("tqq", 2, 0), ("qtq", 0, 2)])
def test_a_route_is_found_over_a_relay(row, asks, asked, key, tmp_path):
    air = Air(row, key, path=tmp_path / "air.pcap")
    air.run(1.0)
    air.send(asks, asked, b"hello")
    assert air.run(1.0, air.finished) and air.received(asked) == [(name(asks), "topic", b"hello", 2)]
    requests, replies = [], []
    for header, fields in air.frames(tmp_path / "air.pcap", key):
        if header["type"] == REQUEST and fields["originator_name"] == name(asks):
            requests.append(fields["hop_count"])
        if header["type"] == REPLY and (fields["destination_name"], fields["hop_count"]) not in replies:
            replies.append((fields["destination_name"], fields["hop_count"]))
    assert set(requests) == {0, 1} and replies == [(name(asked), 0), (name(asked), 1)]


@KEYS
@pytest.mark.parametrize("restarts", ["engine", "twin"])
def test_who_restarts_gets_the_packet_anew(restarts, key):
    air = Air("te", key)
    air.run(1.0)
    sender, receiver = (0, 1) if restarts == "engine" else (1, 0)
    air.send(sender, receiver, noise(100_000))
    assert not air.run(0.01, air.finished)  # in the middle of it
    if restarts == "engine":
        air.bridge.restart(air.engines[1])
    else:
        air.add_twin(0, key, run=1)
    assert air.run(10.0, air.finished)
    assert air.received(receiver) == [(name(sender), "topic", noise(100_000), 1)]


def test_robots_with_another_key_are_not_there():
    air = Air("te", KEY)
    air.add_twin(0, bytes(32))
    air.run(2.0)
    assert air.bridge.neighbors(air.engines[1]) == [] and air.twins[0].names == {}
    assert air.bridge.dropped(air.engines[1])["forged"] > 0 and air.twins[0].malformed > 0


def test_a_recorded_run_is_not_alive(tmp_path):
    path = tmp_path / "air.pcap"
    air = Air("te", KEY, path=path)
    air.run(1.0)
    air.send(1, 0, b"once")
    assert air.run(1.0, air.finished)
    twin, packets = air.twins[0], list(air.received(0))
    air.frames(path, KEY)
    recorded = [frame for frame in capture(path) if frame.source != address(0)]
    for again in recorded:
        twin.receive(*again, now=twin.now)
    assert twin.packets == packets == [(name(1), "topic", b"once", 1)]
    later = Air("t", KEY).add_twin(0, KEY, run=1)
    for again in recorded:
        later.receive(*again, now=later.now)
    assert later.packets == [] and later.names == {} and not any(link.first for link in later.links.values())


def test_a_restarted_twin_takes_nothing_from_before(tmp_path):
    path = tmp_path / "air.pcap"
    air = Air("te", KEY, path=path)
    air.run(1.0)
    air.send(1, 0, b"go")
    assert air.run(1.0, air.finished)
    twin = air.add_twin(0, KEY, run=1)
    air.run(1.0)
    assert twin.links[bytes([2, 0, 0, 0, 0, 0])].first > 0
    air.frames(path, KEY)
    for again in capture(path):
        twin.receive(*again, now=twin.now)
    assert twin.packets == []


@KEYS
@pytest.mark.parametrize("loss", [0.0, 0.2])
@pytest.mark.parametrize(("row", "root"), [("ge", 0), ("gee", 0), ("eg", 0), ("eeg", 0), ("ege", 1), ("gg", 0)])
def test_packets_for_a_group(row, root, loss, key):
    air = Air(row, key, loss)
    air.run(1.0)
    for place, twin in air.twins.items():
        if place != root:
            twin.join(name(root))
    members = [place for place in range(len(row)) if place != root]
    air.run(1.0)
    payloads = [noise(100_000), b"little", noise(3000)]
    for payload in payloads:
        air.send_to(root, "mc_" + name(root), payload)
        assert air.run(20.0, air.finished)
    for member in members:
        assert [packet[2] for packet in air.received(member)] == payloads


def test_who_joins_late_gets_what_is_held():
    air = Air("eg", KEY)
    air.run(1.0)
    air.send_to(0, "mc_robot_0", b"before")
    air.run(0.1)
    air.twins[1].join("robot_0")
    air.run(0.5)
    air.send_to(0, "mc_robot_0", b"after")
    assert air.run(5.0, air.finished)
    assert [packet[2] for packet in air.received(1)] == [b"before", b"after"]


def test_a_member_asks_the_root_for_the_others():
    air = Air("gee", KEY)
    air.run(2.0)
    air.send_to(1, "mc_robot_0", b"to all of us")
    assert air.run(5.0, air.finished)
    assert air.received(0) == [("robot_1", "topic", b"to all of us", 1)] == air.received(2)


def test_the_same_seed_gives_the_same_frames():
    def trace(seed):
        air = Air("ete", KEY, 0.1, seed)
        air.run(0.5)
        air.send(0, 2, noise(10_000))
        assert air.run(5.0, air.finished)
        return air.bridge.trace_hash

    assert trace(1) == trace(1) != trace(2)
