"""What has changed, and its form between processes and in browsers.

A message is the length of a JSON text (4 octets, big endian), the text, then the cells of all tiles, TILE_OCTETS each:

    {"anew": [names of robots of which nothing holds that was told before],
     "robots": {name: {"values": {name: value}, "streams": {name: [number of the first, [items]]}}},
     "maps": [[robot, kind, resolution m, x m, y m, yaw rad]],
     "tiles": [[robot, kind, row, column]], "rest": tiles that are still to come,
     "moment": [s or null, s], if this is all that was known at times from the one to the other}
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass, field
from typing import Any

from mr_grid import Pose
from mr_page.tiles import TILE_OCTETS, Lattice, Place

LENGTH = struct.Struct(">I")


@dataclass
class Changes:
    """Of one robot: values, and of each stream the number of the first new item and the new items."""

    values: dict[str, Any] = field(default_factory=dict)
    streams: dict[str, tuple[int, list[Any]]] = field(default_factory=dict)


@dataclass
class Update:
    """`anew`: robots that are to be forgotten first; `lattices`: maps that begin (robot, kind, lattice); `tiles`: their
    cells (robot, kind, place, cells); `rest`: tiles that are left for the next updates; `moment`: times of the
    past between which this was all that was known (s of the team's clock; the first None: from the beginning), None for
    what has changed."""

    anew: list[str] = field(default_factory=list)
    robots: dict[str, Changes] = field(default_factory=dict)
    lattices: list[tuple[str, str, Lattice]] = field(default_factory=list)
    tiles: list[tuple[str, str, Place, bytes]] = field(default_factory=list)
    rest: int = 0
    moment: tuple[float | None, float] | None = None

    def __bool__(self) -> bool:
        return bool(self.anew or self.robots or self.lattices or self.tiles)


def encoded(update: Update) -> bytes:
    document = {
        "anew": update.anew,
        "robots": {name: _changes_document(part) for name, part in update.robots.items()},
        "maps": [[robot, kind, lattice.resolution, *lattice.corner] for robot, kind, lattice in update.lattices],
        "tiles": [[robot, kind, *place] for robot, kind, place, _ in update.tiles],
        "rest": update.rest,
        **({} if update.moment is None else {"moment": update.moment}),
    }
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
    return b"".join([LENGTH.pack(len(text)), text, *(cells for _, _, _, cells in update.tiles)])


def _changes_document(part: Changes) -> dict[str, Any]:
    document: dict[str, Any] = {}
    if part.values:
        document["values"] = part.values
    if part.streams:
        document["streams"] = part.streams
    return document


def decoded(message: bytes) -> Update:
    """ValueError for what is no message of this kind."""
    try:
        (length,) = LENGTH.unpack_from(message)
        document = json.loads(message[LENGTH.size : LENGTH.size + length])
        cells = message[LENGTH.size + length :]
        if len(cells) != len(document["tiles"]) * TILE_OCTETS:
            raise ValueError(f"{len(document['tiles'])} tiles are told, but there are {len(cells)} octets of cells")
        return Update(
            [str(name) for name in document["anew"]],
            {
                str(name): Changes(dict(part.get("values", {})), dict(part.get("streams", {})))
                for name, part in document["robots"].items()
            },
            [
                (robot, kind, Lattice(float(resolution), Pose(*map(float, corner))))
                for robot, kind, resolution, *corner in document["maps"]
            ],
            [
                (robot, kind, (int(row), int(column)), cells[index * TILE_OCTETS : (index + 1) * TILE_OCTETS])
                for index, (robot, kind, row, column) in enumerate(document["tiles"])
            ],
            int(document["rest"]),
            tuple(document["moment"]) if "moment" in document else None,
        )
    except (struct.error, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"no update of a page: {error}") from error
