"""Measures the exchange on virtual time: how fast maps become equal after losses, and what the messages weigh.

The radio loses whole messages, independently for each receiver, and knows of each whether it arrived. Real radios
repeat frames, so this is harder than the same loss per frame.
"""

import ctypes
from collections import Counter
from dataclasses import dataclass, field
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from mr_grid import UNKNOWN, GridInfo, OccupancyGrid

from .delivery import Delivery, take
from .effects import Send
from .exchange import Exchange, bounds
from .grid import known_box, offset_between
from .messages import Anchor, Request, Tile
from .options import options_of
from .payload import Payload

STEP_S = 0.1
NOTICED_S = 1.0
"""After a partition the radio announces the others this much later."""
PERIOD_S = 3.0
"""Changes are sent this often, as in the launch file."""
ZSTD_LEVEL, WORTH_COMPRESSING = 1, 128
"""As the radio: shorter messages go as they are."""


@dataclass
class LossyTeam:
    """Exchanges by name on a radio that loses `loss` of the messages and lets nothing through between `apart` and the
    others. Time in s."""

    exchanges: Dict[str, Exchange]
    random: np.random.Generator
    loss: float = 0.0
    apart: Tuple[str, ...] = ()
    now: float = 0.0
    octets: int = 0
    """Of everything sent, a message to a group counted once, compressed."""
    payloads: List[Tuple[str, Payload]] = field(default_factory=list)

    def run(self, seconds: float) -> None:
        """Time goes by."""
        for _ in range(round(seconds / STEP_S)):
            self.now += STEP_S
            for name, exchange in self.exchanges.items():
                exchange.tick(self.now)
                self._carry_out(name)

    def part(self, names: Sequence[str]) -> None:
        """These hear nothing of the others from now on; their radios say so."""
        self.apart = tuple(names)
        for name, exchange in self.exchanges.items():
            for other in self._cut_off(name):
                exchange.on_robot_lost(other)

    def join(self) -> None:
        """Everybody hears everybody again."""
        before = {name: self._cut_off(name) for name in self.exchanges}
        self.apart = ()
        self.run(NOTICED_S)
        for name, others in before.items():
            for other in others:
                self.exchanges[name].on_robot(other, self.now, returned=True)
                self._carry_out(name)

    def _cut_off(self, name: str) -> List[str]:
        return [other for other in self.exchanges if (other in self.apart) != (name in self.apart)]

    def _carry_out(self, name: str) -> None:
        exchange = self.exchanges[name]
        while True:
            sends = [effect for effect in exchange.effects() if isinstance(effect, Send)]
            if not sends:
                return
            for send in sends:
                delivery = Delivery(send)
                while delivery.next is not None:
                    delivery.ended(self._deliver(name, send, delivery.next))
                delivery.report(exchange, self.now)

    def _deliver(self, name: str, send: Send, payload: Payload) -> bool:
        self.octets += compressed(payload)
        self.payloads.append((name, payload))
        reachable = [other for other in self.exchanges if other != name and other not in self._cut_off(name)]
        receivers = reachable if send.to_group else [send.destination]
        heard = [other for other in receivers if other in reachable and self.random.random() >= self.loss]
        for other in heard:
            take(self.exchanges[other], payload, self.now)
        return len(heard) == len(receivers)


class GrowingMap:
    """A map that grows in all directions, with walls that are taken back now and then; drawn from `random`."""

    def __init__(self, random: np.random.Generator, size: int = 200) -> None:
        self._random = random
        self._cells = np.full((size, size), UNKNOWN, np.int8)
        self._place = np.array([size / 2, size / 2])

    def grow(self) -> OccupancyGrid:
        """The next map: a disc around the next place becomes known, a piece unknown."""
        size, random = len(self._cells), self._random
        self._place = np.clip(self._place + random.normal(0.0, 8.0, 2), 20, size - 20)
        rows, columns = np.indices(self._cells.shape)
        seen = np.hypot(rows - self._place[0], columns - self._place[1]) < 15.0
        self._cells[seen] = np.where(random.random(int(seen.sum())) < 0.05, 100, 0)
        top, left = random.integers(0, size - 6, 2)
        self._cells[top : top + 6, left : left + 6] = UNKNOWN
        return OccupancyGrid(GridInfo(size, size, 0.05), self._cells.copy())


class Outcome(NamedTuple):
    """A run of the scenario: seconds from the end of the partition until all copies are equal (None: not within the
    patience), requests sent in all."""

    seed: int
    seconds: Optional[float]
    requests: int


def reconnect(seed: int, robots: int = 4, loss: float = 0.3, patience: float = 60.0) -> Outcome:
    """Robots map under `loss`; one restarts; the team is parted into halves for 60 s, in which a robot of the other
    half restarts too; then they meet again. Mapping ends with the partition, losses go on."""
    random = np.random.default_rng(seed)
    names = [f"robot_{number}" for number in range(robots)]
    team = LossyTeam({name: _exchange(name, (1, number)) for number, name in enumerate(names)}, random, loss)
    for exchange in team.exchanges.values():
        for other in names:
            exchange.on_robot(other, team.now)
    maps = {name: GrowingMap(random) for name in names}
    last: Dict[str, OccupancyGrid] = {}

    def drive(seconds: float) -> None:
        for _ in range(round(seconds / PERIOD_S)):
            for name in names:
                last[name] = maps[name].grow()
                team.exchanges[name].on_local_map(last[name])
            team.run(PERIOD_S)

    def restart(name: str) -> None:
        maps[name] = GrowingMap(random)
        team.exchanges[name] = _exchange(name, (2, names.index(name)))

    drive(30.0)
    restart(names[0])
    drive(30.0)
    team.part(names[robots // 2 :])
    drive(30.0)
    restart(names[-1])
    drive(30.0)
    reconnected = team.now
    team.join()
    while not all_equal(team, last) and team.now - reconnected < patience:
        team.run(STEP_S)
    requests = sum(isinstance(payload, Request) for _, payload in team.payloads)
    return Outcome(seed, round(team.now - reconnected, 1) if all_equal(team, last) else None, requests)


def _exchange(name: str, boot: Tuple[int, int]) -> Exchange:
    return Exchange(options_of({"debug": False, "seconds_send_timer": int(PERIOD_S)}, name), boot)


def all_equal(team: LossyTeam, maps: Dict[str, OccupancyGrid]) -> bool:
    """True if each robot has the map of each other one, cell by cell."""
    return all(
        same(exchange.map_of(other), maps[other])
        for name, exchange in team.exchanges.items()
        for other in maps
        if other != name
    )


def same(copy: Optional[OccupancyGrid], original: OccupancyGrid) -> bool:
    """True if the copy has all known cells of the original and no others."""
    box = known_box(original)
    if copy is None:
        return box.empty
    return (
        copy.info.shape == box.shape
        and offset_between(copy.info, original.info) == (box.top, box.left)
        and np.array_equal(copy.cells, original.cells[box.slices()])
    )


class Traffic(NamedTuple):
    """Compressed bytes of a robot that told its growing map, and had it told the whole map each time."""

    changes: int
    whole: int
    minutes: float
    parts: Mapping[str, int]
    """The changes by kind of message."""


def traffic(stages: Sequence[OccupancyGrid], split_size: int) -> Traffic:
    """One robot tells another the stages of its map, one each PERIOD_S, without losses. Anchors, requests and answers
    count; `whole` is the known box of each stage as one message."""
    names = ("robot_0", "robot_1")
    given = {"debug": False, "split_size": split_size, "seconds_send_timer": int(PERIOD_S)}
    options = [options_of(given, name) for name in names]
    team = LossyTeam(
        {each.robot_name: Exchange(each, (1, number)) for number, each in enumerate(options)}, np.random.default_rng(0)
    )
    for name, other in (names, names[::-1]):
        team.exchanges[name].on_robot(other, team.now)
    whole = 0
    for grid in stages:
        team.exchanges["robot_0"].on_local_map(grid)
        team.run(PERIOD_S)
        box = known_box(grid)
        whole += compressed(Tile("robot_0", (0,), 0, 0, grid.cells[box.slices()], grid.info.resolution, (1, 0), 1))
    team.run(bounds.MARGINAL_HELD_S + PERIOD_S)
    if not same(team.exchanges["robot_1"].map_of("robot_0"), stages[-1]):
        raise AssertionError("the copy differs from the map")
    parts: Counter = Counter()
    for _, payload in team.payloads:
        parts[type(payload).__name__] += compressed(payload)
    return Traffic(team.octets, whole, len(stages) * PERIOD_S / 60.0, parts)


def compressed(payload: Payload) -> int:
    """Bytes of the payload's message, compressed as the radio does it. OSError without the library of zstd, which
    adhoc_communication needs, too."""
    octets = _octets(payload)
    if len(octets) < WORTH_COMPRESSING:
        return len(octets)
    zstd = ctypes.CDLL("libzstd.so.1")
    zstd.ZSTD_compressBound.restype = zstd.ZSTD_compress.restype = ctypes.c_size_t
    room = zstd.ZSTD_compressBound(ctypes.c_size_t(len(octets)))
    target = ctypes.create_string_buffer(room)
    size = zstd.ZSTD_compress(target, ctypes.c_size_t(room), octets, ctypes.c_size_t(len(octets)), ZSTD_LEVEL)
    return min(len(octets), int(size))


def _octets(payload: Payload) -> bytes:
    """As long as the message of the contract, with the same values."""
    if isinstance(payload, Tile):
        place = np.array([payload.row, payload.column, payload.whole, 0.0, 0.0, 0.0, 1.0])
        head = np.array([payload.updates, *payload.boot, *payload.cells.shape, *payload.numbers], np.int32)
        return 2 * payload.robot.encode() + bytes(24) + head.tobytes() + place.tobytes() + payload.cells.tobytes()
    if isinstance(payload, Anchor):
        origin = payload.info.origin
        place = np.array([origin.x, origin.y, 0.0, 0.0, 0.0, origin.yaw, 1.0])
        numbers = np.array([payload.updates, *payload.boot], np.int32)
        return payload.robot.encode() + bytes(24) + numbers.tobytes() + place.tobytes()
    if isinstance(payload, Request):
        return payload.robot.encode() + bytes(8) + np.array(payload.numbers, np.int32).tobytes()
    return bytes(100)
