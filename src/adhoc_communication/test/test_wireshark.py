"""The Wireshark dissector: its syntax, and what tshark makes of one frame of each type."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest
from namespaces import program

DISSECTOR = Path(__file__).resolve().parents[1] / "wireshark" / "adhoc_communication.lua"
COMPILERS = ("luac5.3", "luac5.2", "luac5.4", "luac")


def test_syntax():
    compiler = next((path for path in map(shutil.which, COMPILERS) if path), None)
    if compiler is None:
        pytest.skip("no Lua compiler is installed (Debian: lua5.3)")
    result = subprocess.run([compiler, "-p", str(DISSECTOR)], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr


@pytest.fixture(scope="module")
def all_frames(tmp_path_factory):
    """The fields of each sample frame by their names, in the order of the capture."""
    if shutil.which("tshark") is None:
        pytest.skip("tshark is not installed")
    capture = tmp_path_factory.mktemp("capture") / "sample.pcap"
    subprocess.run([program("sample_frames"), str(capture)], check=True)
    command = ["tshark", "-X", f"lua_script:{DISSECTOR}", "-r", str(capture), "-T", "json", "--no-duplicate-keys"]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert "Lua" not in result.stderr, result.stderr
    return [packet["_source"]["layers"] for packet in json.loads(result.stdout)]


@pytest.fixture
def frames(all_frames):
    """Those that are whole and open: one of each type at least."""
    return all_frames[:-3]


@pytest.fixture
def odd_frames(all_frames):
    """A sealed, an altered and a cut one."""
    return all_frames[-3:]


def values(node, name):
    """Every value of a field anywhere in the tree."""
    if isinstance(node, list):
        return [value for item in node for value in values(item, name)]
    if not isinstance(node, dict):
        return []
    own = node.get(name, [])
    found = [value for value in (own if isinstance(own, list) else [own]) if isinstance(value, str)]
    return found + [value for item in node.values() for value in values(item, name)]


def expect(frame, **fields):
    for name, expected in fields.items():
        full_name = "adhoc." + name.replace("__", ".")
        wanted = expected if isinstance(expected, list) else [expected]
        assert values(frame, full_name) == [str(value) for value in wanted], full_name


ALICE, BOB, CAROL = (f"02:00:00:00:00:0{number}" for number in (1, 2, 3))


def test_every_frame_has_header_and_right_checksum(frames):
    assert {int(values(frame, "adhoc.type")[0]) for frame in frames} == set(range(1, 16))
    for number, frame in enumerate(frames, start=1):
        expect(frame, version=2, sender=ALICE, counter=number, next_hop=BOB, link_sequence=77, checksum_good=1)
        assert "adhoc.malformed" not in json.dumps(frame)


def test_times_are_nanoseconds(frames):
    assert frames[0]["frame"]["frame.time_epoch"].startswith("1000000000.000000001")


def test_beacon(frames):
    expect(
        frames[0],
        type=1,
        sequence=5,
        alive=[6, 3],
        name=["alice", "carol"],
        heard="00:00:00:00:00:b1",
        robot=CAROL,
        hops=2,
    )
    expect(frames[0], beacon_number=3, heard_count=2, named_count=1, loss=51, extension__type=1)


def test_route_request(frames):
    expect(frames[1], type=2, hop_count=1, hop_limit=7, cost=20, id=42, destination=CAROL, destination_sequence=10)
    expect(frames[1], originator=ALICE, originator_sequence=11, destination_name="carol", originator_name="alice")
    expect(frames[1], request__gratuitous=1, request__repair=0, request__unknown_sequence=1, request__directed=0)


def test_route_reply(frames):
    expect(frames[2], type=3, flags__wants_acknowledgment=1, flags__acknowledge_now=0, reply__acknowledgment=1)
    expect(frames[2], destination=CAROL, originator=ALICE, lifetime=3000, destination_name="carol")


def test_route_error(frames):
    expect(frames[3], type=4, unreachable_count=2, destination=[CAROL, BOB], destination_sequence=[13, 14])


def test_hop_acknowledgment(frames):
    expect(frames[4], type=5, newest_counter=99, spacing=1200, held=800, highest=55)


def test_data(frames):
    expect(frames[5], type=6, source=ALICE, destination=CAROL, priority=1, hops=2, packet=9, base=8, index=0)
    expect(frames[5], image__group="mc_alice", image__topic="greeting", image__payload_size=2, image__payload="68:69")
    expect(frames[6], index=1, image__topic=[])
    assert len(values(frames[6], "adhoc.segment")[0].split(":")) == int(values(frames[6], "adhoc.segment_size")[0])


def test_transport_acknowledgment(frames):
    expect(frames[7], type=7, stream="0x03", next_packet=20, partial_count=2, packet=[21, 22, 23], first_missing=[4, 0])
    expect(frames[7], bitmap_size=[2, 0], bitmap="0f:01", refused_count=1, attempt=[1, 0, 2])


def test_broadcast_data_and_flood(frames):
    expect(frames[8], type=8, packet=3, image__topic="greeting")
    expect(frames[9], type=9, hop_count=1, hop_limit=3, source_name="alice", image__topic="greeting")


def test_group_tree(frames):
    expect(frames[10], type=10, root=ALICE, epoch=7, member=[BOB, CAROL])
    expect(frames[11], type=11, root=ALICE, epoch=7, member=CAROL)


def test_group_data_and_report(frames):
    expect(frames[12], type=12, priority=2, stream__report=1, stream__follows=0, round=5, packet=31, base=30)
    expect(frames[12], block=0, symbol=0, image__topic="greeting")
    expect(frames[13], symbol=130, image__topic=[], segment="09:09:09")
    expect(frames[14], segment=[], image__topic=[])
    expect(frames[15], type=13, stream__complete=1, epoch=7, measured_counter=98, spacing=1300, first_block=4)
    expect(frames[15], missing=[3, 0], coverage="0x00c0ffee")


def test_flooded_group_data_and_receipts(frames):
    expect(frames[17], type=12, stream__flooded=1, stream__report=0, image__topic="greeting")
    expect(frames[18], type=15, member_count=2, root=[ALICE, ALICE], member=[BOB, CAROL], next_packet=[32, 31])
    expect(frames[18], beyond=["0x00000000", "0x00000001"], stream__by_route=[0, 1])


def test_sealed_frame_stays_closed(odd_frames):
    expect(odd_frames[0], type=6, flags__sealed=1, image__topic=[], source=[])
    assert len(values(odd_frames[0], "adhoc.tag")[0].split(":")) == 16
    assert len(values(odd_frames[0], "adhoc.sealed_body")[0].split(":")) == 14


def test_altered_and_cut_frames_are_marked(odd_frames):
    expect(odd_frames[1], checksum_good=0)
    assert "Malformed" in json.dumps(odd_frames[2])
