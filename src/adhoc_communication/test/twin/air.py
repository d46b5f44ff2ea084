"""Robots in a row on the simulated radio, in virtual time: some with the engine, some with the one in Python."""

import sys
from pathlib import Path
from typing import Callable, Dict, List, Optional, Tuple

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import frames
from captures import capture
from namespaces import program
from robot import MS, Robot

sys.path.insert(0, str(Path(program("twin_bridge.so")).parent))

import twin_bridge

SPACING = 8.0  # m; each hears the next only


class Air:
    """`row`: for each robot "e", the engine that joins all groups, "q", one that joins none, or "t", the twin."""

    def __init__(
        self, row: str, key: Optional[bytes] = None, loss: float = 0.0, seed: int = 1, path: Optional[Path] = None
    ) -> None:
        self.bridge = twin_bridge.Bridge(loss, seed, key, None if path is None else str(path))
        self.engines: Dict[int, int] = {}
        self.twins: Dict[int, Robot] = {}
        self.stations: Dict[int, int] = {}
        for place, kind in enumerate(row):
            if kind == "t":
                self.add_twin(place, key)
            else:
                self.engines[place] = self.bridge.add_robot(name(place), SPACING * place, kind == "e")
        self.sent: List[Tuple[int, int]] = []

    def add_twin(self, place: int, key: Optional[bytes], run: int = 0) -> Robot:
        boot_id = bytes([run, place]) * 8
        self.twins[place] = Robot(name(place), address(place), boot_id, self.bridge.now, key)
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
        if place in self.twins:
            self.twins[place].send(name(to), "topic", payload)
        else:
            self.sent.append((place, self.bridge.send(self.engines[place], name(to), payload)))

    def finished(self) -> bool:
        """Every packet has arrived, and its sender knows."""
        ends = [self.bridge.end_of(self.engines[place], number) for place, number in self.sent]
        assert all(end is None or end[0] for end in ends), ends
        twins = [stream.packets for twin in self.twins.values() for stream in twin.streams.values()]
        return None not in ends and not any(twins)

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
