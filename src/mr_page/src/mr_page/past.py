"""What a page has shown before: all that was known at moments of the past. Knows no socket and no clock."""

from __future__ import annotations

import json
import zlib
from bisect import bisect_right
from typing import NamedTuple

from mr_page.state import PageState, RobotView
from mr_page.stream import Stream
from mr_page.tiles import BLANK, MAX_TILES, Lattice, Place, TiledMap
from mr_page.update import Changes, Update
from mr_page.viewer import Wanted

PERIOD = 2.0  # s between two moments, until there are too many
MOST_MOMENTS = 300
MOST_OCTETS = 64_000_000  # of values and tiles, compressed
OTHER_CLOCK = 3600.0  # s between two clocks that are not the same
LEVEL = 1  # of compression: moments are many, and read seldom


class _Robot(NamedTuple):
    """One run at one moment: its values as compressed JSON, its streams and the number behind the last item of each."""

    run: int
    values: bytes
    streams: dict[str, Stream]
    ends: dict[str, int]


class _Moment(NamedTuple):
    number: int
    time: float
    robots: dict[str, _Robot]


class Past:
    """Moments of a state that somebody else changes, PERIOD s apart. Beyond MOST_MOMENTS or MOST_OCTETS every second
    one is forgotten, and further ones are taken half as often: the whole mission stays, more coarsely."""

    def __init__(self, state: PageState, most_moments: int = MOST_MOMENTS, most_octets: int = MOST_OCTETS) -> None:
        self._state = state
        self._most_moments, self._most_octets = most_moments, most_octets
        self._period = PERIOD
        self._due = -float("inf")
        self._number = 0
        self._moments: list[_Moment] = []
        self._films: dict[tuple[int, str, int], _Film] = {}  # by run, kind and version of the lattice
        self._octets = 0  # of the values

    def __len__(self) -> int:
        return len(self._moments)

    @property
    def octets(self) -> int:
        return self._octets + sum(film.octets for film in self._films.values())

    def note(self, now: float) -> None:
        """Take a moment if it is time; `now`: s on any steady clock."""
        time = team_time(self._state)
        if now < self._due or time is None:
            return
        self._due = now + self._period
        self._number += 1
        before = self._moments[-1].robots if self._moments else {}
        robots = {name: _robot(view, before.get(name)) for name, view in self._state.robots.items()}
        self._moments.append(_Moment(self._number, time, robots))
        for view in self._state.robots.values():
            for kind, tiled in view.maps.items():
                if tiled.lattice is not None:
                    key = (view.run, kind, tiled.lattice_version)
                    self._films.setdefault(key, _Film(tiled.lattice)).note(self._number, tiled)
        self._count()
        while len(self._moments) > 1 and (len(self._moments) > self._most_moments or self.octets > self._most_octets):
            self._thin()

    def at(self, time: float, wants: Wanted) -> Update | None:
        """All that was known at the last moment not after `time`, or at the first one, as an update for a page that
        knows nothing: of maps those that are wanted. None while there is no moment."""
        if not self._moments:
            return None
        # Not by bisection: a clock may have jumped.
        index = max((i for i, moment in enumerate(self._moments) if moment.time <= time), default=0)
        moment, after = self._moments[index], self._moments[index + 1 : index + 2]
        begin = moment.time if index else None
        update = Update(anew=list(moment.robots), moment=(begin, max([time, *(one.time for one in after)])))
        for name, robot in moment.robots.items():
            streams = {key: robot.streams[key].since(0, end) for key, end in robot.ends.items()}
            update.robots[name] = Changes(json.loads(zlib.decompress(robot.values)), streams)
        runs = {robot.run: name for name, robot in moment.robots.items()}
        for (run, kind, _), film in self._films.items():
            if run in runs and wants(runs[run], kind) and film.shown_at(moment.number):
                update.lattices.append((runs[run], kind, film.lattice))
                update.tiles += [(runs[run], kind, place, cells) for place, cells in film.tiles_at(moment.number)]
        return update

    def _count(self) -> None:
        kept = {id(robot.values): len(robot.values) for moment in self._moments for robot in moment.robots.values()}
        self._octets = sum(kept.values())

    def _thin(self) -> None:
        """Forget every second moment; the newest stays."""
        self._moments = self._moments[::-1][::2][::-1]
        self._period *= 2.0
        numbers = [moment.number for moment in self._moments]
        for film in self._films.values():
            film.keep(numbers)
        self._films = {key: film for key, film in self._films.items() if film.begin is not None}
        self._count()


class _Film:
    """How the tiles of one map have changed on one lattice. `begin`, `end`: numbers of the first and last moment at
    which the map was this one; None: of none that is kept."""

    def __init__(self, lattice: Lattice) -> None:
        self.lattice = lattice
        self.begin: int | None = None
        self.end = 0
        self.octets = 0
        self._version = 0
        self._tiles: dict[Place, list[tuple[int, bytes]]] = {}  # number of the moment, compressed cells

    def note(self, number: int, tiled: TiledMap) -> None:
        self.begin = number if self.begin is None else self.begin
        self.end = number
        changed = tiled.changed_since(self._version, MAX_TILES)
        self._version = changed.version
        for place, cells in changed.tiles:
            packed = zlib.compress(cells, LEVEL)
            self._tiles.setdefault(place, []).append((number, packed))
            self.octets += len(packed)

    def shown_at(self, number: int) -> bool:
        return self.begin is not None and self.begin <= number <= self.end

    def tiles_at(self, number: int) -> list[tuple[Place, bytes]]:
        found = []
        for place, entries in self._tiles.items():
            index = bisect_right(entries, number, key=lambda entry: entry[0]) - 1
            cells = zlib.decompress(entries[index][1]) if index >= 0 else BLANK
            if cells != BLANK:
                found.append((place, cells))
        return found

    def keep(self, numbers: list[int]) -> None:
        """Forget what is not needed for these moments, in growing order."""
        shown = [number for number in numbers if self.shown_at(number)]
        self.begin = shown[0] if shown else None
        for entries in self._tiles.values():
            # Of the changes between two moments the last one counts.
            last = {bisect_right(numbers, entry[0] - 1): entry for entry in entries}
            entries[:] = [entry for place, entry in last.items() if place < len(numbers)]
        self.octets = sum(len(cells) for entries in self._tiles.values() for _, cells in entries)


def _robot(view: RobotView, before: _Robot | None) -> _Robot:
    values = zlib.compress(json.dumps(view.values, separators=(",", ":")).encode(), LEVEL)
    if before is not None and before.values == values:
        values = before.values
    return _Robot(view.run, values, view.streams, {key: stream.end for key, stream in view.streams.items()})


def team_time(state: PageState) -> float | None:
    """The time that a page of this state shows, s: the latest of all robots on the clock of those with a body, since a
    base station beside a simulated team has another one. None while nobody has told the time."""
    times = [(bool(state.get(name, "about", {}).get("base")), time) for name in state.robots
             if (time := state.get(name, "time")) is not None]  # fmt: skip
    if not times:
        return None
    reference = min(times)[1] if all(base for base, _ in times) else next(time for base, time in times if not base)
    return max(time for _, time in times if abs(time - reference) <= OTHER_CLOCK)
