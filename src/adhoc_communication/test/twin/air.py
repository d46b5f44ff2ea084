"""Robots in a row on the simulated radio, in virtual time: some with the engine, some with the one in Python."""

import sys
from pathlib import Path
from typing import Callable, Dict, List, Optional, Tuple, Type

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import frames
from captures import capture
from group import GroupRobot
from namespaces import program
from robot import MS, Robot

sys.path.insert(0, str(Path(program("twin_bridge.so")).parent))

import twin_bridge

SPACING = 8.0  # m; each hears the next only


class Air:
    """`row` has for each robot "e", the engine, which joins all groups, "q", one that joins none, "t", the twin,
    or "g", one that knows groups."""

    def __init__(
        self,
        row: str,
        key: Optional[bytes] = None,
        loss: float = 0.0,
        seed: int = 1,
        path: Optional[Path] = None,
        mtu: int = 1500,
    ) -> None:
        self.bridge = twin_bridge.Bridge(loss, seed, key, None if path is None else str(path))
        self.engines: Dict[int, int] = {}
        self.twins: Dict[int, Robot] = {}
        self.stations: Dict[int, int] = {}
        for place, kind in enumerate(row):
            if kind in "tg":
                self.add_twin(place, key, kind=Robot if kind == "t" else GroupRobot)
            else:
                self.engines[place] = self.bridge.add_robot(name(place), SPACING * place, kind == "e", mtu)
        self.sent: List[Tuple[int, int]] = []

    def add_twin(self, place: int, key: Optional[bytes], run: int = 0, kind: Type[Robot] = Robot) -> Robot:
        boot_id = bytes([run, place]) * 8
        self.twins[place] = kind(name(place), address(place), boot_id, self.bridge.now, key)
        if place not in self.stations:
            self.stations[place] = self.bridge.add_station(name(place), address(place), SPACING * place)
        return self.twins[place]

    def run(self, seconds: float, done: Callable[[], bool] = lambda: False) -> bool:
        """Until `done`, which is returned, or for that long."""
        end = self.bridge.now + int(seconds * 1000) * MS
        places = {station: place for place, station in self.stations.items()}
        while not done() and self.bridge.now < end:
            until = min([end, *(twin.deadline() for twin in self.twins.values())])
            for station, destination, source, octets in self.bridge.advance(until):
                self.twins[places[station]].receive(destination, source, octets, self.bridge.now)
            for place, twin in self.twins.items():
                for destination, octets in twin.poll(self.bridge.now):
                    self.bridge.transmit(self.stations[place], destination, octets)
        return done()

    def send(self, place: int, to: int, payload: bytes) -> None:
        self.send_to(place, name(to), payload)

    def send_to(self, place: int, destination: str, payload: bytes) -> None:
        """To a robot, or to the group of one."""
        twin = self.twins.get(place)
        if twin is None:
            self.sent.append((place, self.bridge.send(self.engines[place], destination, payload)))
        elif isinstance(twin, GroupRobot) and destination == twin.group:
            twin.send_to_group("topic", payload)
        else:
            twin.send(destination, "topic", payload)

    def finished(self) -> bool:
        """Every packet has arrived, and its sender knows."""
        ends = [self.bridge.end_of(self.engines[place], number) for place, number in self.sent]
        assert all(end is None or end[0] for end in ends), ends
        streams = any(stream.packets for twin in self.twins.values() for stream in twin.streams.values())
        groups = any(twin.sending for twin in self.twins.values() if isinstance(twin, GroupRobot))
        return None not in ends and not streams and not groups

    def received(self, place: int) -> List[Tuple[str, str, bytes, int]]:
        """Source, topic, payload and hops of each packet."""
        return self.twins[place].packets if place in self.twins else self.bridge.received(self.engines[place])

    def frames(self, path: Path, key: Optional[bytes]) -> List[Tuple[frames.Fields, frames.Fields]]:
        """Header and body of everything that was on the air; the end of it."""
        self.bridge = None  # completes the capture
        return [frames.open_frame(captured.octets, key) for captured in capture(path)]


def name(place: int) -> str:
    return f"robot_{place}"


def address(place: int) -> bytes:
    return bytes([2, 0, 0, 1, 0, place])
