"""Frames and packets, by the tables of docs/protocol.md and without the engine."""

import hashlib
import re
import zlib
from pathlib import Path
from typing import Any, Dict, List, Optional, Tuple

import zstandard
from nacl.bindings import crypto_aead_chacha20poly1305_ietf_decrypt, crypto_aead_chacha20poly1305_ietf_encrypt
from nacl.exceptions import CryptoError

DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "protocol.md"
SEALED, WANTS_ACKNOWLEDGMENT, ACKNOWLEDGE_NOW = 1, 2, 4
EVERYBODY, NOBODY = b"\xff" * 6, bytes(6)
LENGTHS = {"name": 1, "text": 1, "long text": 2, "counted octets": 1}

Fields = Dict[str, Any]
Layout = List[Tuple[str, str, str, Any]]  # name, type and what is allowed of each field, layout of the items of a list


class Malformed(ValueError):
    """What arrived is not what the document describes."""


def layouts() -> Dict[str, Layout]:
    """The tables of fields by the headings that they stand under."""

    def nested(rows: List[Tuple[str, str, str]], prefix: str) -> Layout:
        own = [row for row in rows if re.fullmatch(re.escape(prefix) + r"\w+", row[0])]
        return [(name[len(prefix) :], kind, text.strip(), nested(rows, name + ".")) for name, kind, text in own]

    sections = re.split(r"^##+ ", DOCUMENT.read_text(encoding="utf-8"), flags=re.M)
    row = re.compile(r"^\| `([\w.]+)` \| ([a-z0-9 ]+) \| ([^|]*)\|", flags=re.M)
    return {section.partition("\n")[0]: nested(row.findall(section), "") for section in sections}


LAYOUTS = layouts()
BODIES = {int(name.split()[0]): layout for name, layout in LAYOUTS.items() if name[:1].isdigit()}
HEADER, IMAGE = LAYOUTS["Every frame"], LAYOUTS["Packet image"]


def is_name(text: str) -> bool:
    return re.fullmatch(r"[!-~]{1,64}", text) is not None


def allows(kind: str, allowed: str, value: Any) -> bool:
    if (kind == "name" and not is_name(value)) or (kind == "address" and (value == NOBODY or value[0] & 1)):
        return False
    if allowed.startswith("bits"):
        return int(value) & ~int(allowed[5:], 16) == 0
    least, most = map(int, (allowed or f"0 to {2**64}").split(" to "))
    return least <= (value if isinstance(value, int) else len(value)) <= most


class Reader:
    def __init__(self, octets: bytes) -> None:
        self.octets = octets

    def take(self, size: int) -> bytes:
        if size > len(self.octets):
            raise Malformed("too short")
        taken, self.octets = self.octets[:size], self.octets[size:]
        return taken

    def one(self, kind: str, inner: Layout) -> Any:
        if kind[0] == "u":
            return int.from_bytes(self.take(int(kind[1:]) // 8), "big")
        if kind in LENGTHS:
            octets = self.take(int.from_bytes(self.take(LENGTHS[kind]), "big"))
            return octets if kind == "counted octets" else octets.decode("latin-1")
        if kind == "list":
            return [self.fields(inner) for _ in range(self.take(1)[0])]
        if kind == "extensions":
            found = {}
            while self.octets:
                number, length = self.take(2)
                found[number] = self.take(length)
            return found
        return self.take(
            len(self.octets) if kind == "rest" else 6 if kind.endswith("address") else int(kind.split()[0])
        )

    def fields(self, layout: Layout) -> Fields:
        found: Fields = {}
        for name, kind, allowed, inner in layout:
            found[name] = self.one(kind, inner)
            if not allows(kind, allowed, found[name]) or (
                kind == "extensions" and {0, *range(128, 256)} & found[name].keys()
            ):
                raise Malformed(name)
        return found


def write(layout: Layout, fields: Fields) -> bytes:
    octets = b""
    for name, kind, _, inner in layout:
        value = fields[name]
        if kind[0] == "u":
            octets += int(value).to_bytes(int(kind[1:]) // 8, "big")
        elif kind == "list":
            octets += bytes([len(value)]) + b"".join(write(inner, item) for item in value)
        elif kind == "extensions":
            octets += b"".join(bytes([number, len(data)]) + data for number, data in value.items())
        else:
            value = value.encode("latin-1") if isinstance(value, str) else value
            octets += (len(value).to_bytes(LENGTHS[kind], "big") if kind in LENGTHS else b"") + value
    return octets


def agrees(kind: int, fields: Fields) -> bool:
    """What the tables say in words."""
    if kind == 2 and fields["destination_name"] == "":
        return bool(fields["destination"] != NOBODY)
    if kind in (6, 8):
        size, left = fields["segment_size"], fields["total"] - fields["index"] * fields["segment_size"]
        return bool(size >= 64 or fields["total"] <= size) and len(fields["octets"]) == min(size, left)
    if kind == 12 and fields["stream"] & 0x20:
        whole = (fields["block"], fields["symbol"], len(fields["octets"])) == (0, 0, fields["total"])
        return whole and fields["total"] <= fields["segment_size"] and not fields["stream"] & 0x80
    if kind == 12:
        return len(fields["octets"]) <= fields["segment_size"] and bool(fields["octets"] or fields["stream"] & 0x80)
    return kind != 2 or is_name(fields["destination_name"])


def session_key(team_key: bytes, sender: bytes, boot_id: bytes) -> bytes:
    purpose = b"adhoc_communication frame v1\0"
    return hashlib.blake2b(purpose + sender + boot_id, digest_size=32, key=team_key).digest()


def close(header: Fields, fields: Fields, team_key: Optional[bytes] = None) -> bytes:
    """The frame as it goes on the air."""
    body = write(BODIES[header["type"]], fields)
    if team_key is None:
        octets = write(HEADER, header) + body
        return octets + zlib.crc32(octets).to_bytes(4, "big")
    head = write(HEADER, {**header, "flags": header["flags"] | SEALED})
    key = session_key(team_key, header["sender"], header["boot_id"])
    return head + crypto_aead_chacha20poly1305_ietf_encrypt(body, head, header["counter"].to_bytes(12, "big"), key)


def open_frame(octets: bytes, team_key: Optional[bytes] = None) -> Tuple[Fields, Fields]:
    """Header and body. Raises Malformed for what is no frame of this protocol, or not sealed as it should be."""
    reader = Reader(octets)
    header = reader.fields(HEADER)
    if bool(header["flags"] & SEALED) != (team_key is not None):
        raise Malformed("open where it should be sealed, or sealed without a key")
    if team_key is not None:
        key, nonce = session_key(team_key, header["sender"], header["boot_id"]), header["counter"].to_bytes(12, "big")
        try:
            body = crypto_aead_chacha20poly1305_ietf_decrypt(reader.octets, octets[: -len(reader.octets)], nonce, key)
        except (CryptoError, ValueError) as error:
            raise Malformed("forged") from error
    elif zlib.crc32(octets[:-4]).to_bytes(4, "big") != octets[-4:] or len(reader.octets) < 4:
        raise Malformed("checksum")
    reader = Reader(reader.octets[:-4] if team_key is None else body)
    fields = reader.fields(BODIES[header["type"]])
    if reader.octets or not agrees(header["type"], fields):
        raise Malformed("body")
    return header, fields


def write_image(kind: int, group: str, topic: str, payload: bytes, payload_type: int = 0) -> bytes:
    """A packet, uncompressed."""
    fields = {"flags": 0, "kind": kind, "payload_type": payload_type, "group": group, "topic": topic}
    return write(IMAGE, {**fields, "payload_size": len(payload), "payload": payload})


def read_image(octets: bytes, largest: int = 10_000_000) -> Fields:
    """A packet, its payload unpacked."""
    image = Reader(octets).fields(IMAGE)
    if image["flags"] & 1 and image["payload_size"] <= largest:
        unpacker = zstandard.ZstdDecompressor().decompressobj()
        try:
            image["payload"] = unpacker.decompress(image["payload"])
        except zstandard.ZstdError as error:
            raise Malformed("packet image") from error
        if unpacker.unused_data:
            raise Malformed("packet image")
    if len(image["payload"]) != image["payload_size"]:
        raise Malformed("packet image")
    return image
