"""What one viewer of a page knows already, and so what to tell him next."""

from __future__ import annotations

from typing import Callable

from mr_page.state import PageState, RobotView
from mr_page.tiles import TiledMap
from mr_page.update import Changes, Update

PERIOD = 0.1  # s between two updates
MAP_PERIOD = 1.0  # s between two looks at a map that the viewer knows
TILES = 384  # in one update; the rest follows in the next ones

Wanted = Callable[[str, str], bool]
"""Whether the viewer looks at the map of this robot and kind."""


class Viewer:
    """A viewer who has to be told everything that is new to him, not more often than every PERIOD.

    What changes several times between two updates is told once, so a slow viewer costs no memory.

    Args:
        period: s between two updates.
        map_period: s between two looks at a map that is known.
    """

    def __init__(self, state: PageState, period: float = PERIOD, map_period: float = MAP_PERIOD) -> None:
        self.wants: Wanted = lambda robot, kind: True
        self._state = state
        self._period = period
        self._map_period = map_period
        self._due = -float("inf")
        self._robots: dict[str, _Known] = {}

    def update(self, now: float) -> Update | None:
        """All that is new at `now` (s on any steady clock); None if it is too early or nothing has changed."""
        if now < self._due:
            return None
        late = now - self._due
        self._due = now + self._period - (late if late < self._period else 0.0)  # keeps the rate if calls come late
        update = Update()
        for name, view in self._state.robots.items():
            known = self._robots.get(name)
            if known is None or known.run != view.run:
                known = self._robots[name] = _Known(view.run)
                update.anew.append(name)
            changes = known.changes(view)
            if changes.values or changes.streams:
                update.robots[name] = changes
            for kind, tiled in view.maps.items():
                if tiled.lattice is not None and self.wants(name, kind):
                    known.maps.setdefault(kind, _KnownMap()).add(update, name, kind, tiled, now, self._map_period)
        return update or None


class _Known:
    """What a viewer knows of one run of a robot."""

    def __init__(self, run: int) -> None:
        self.run = run
        self.maps: dict[str, _KnownMap] = {}
        self._version = 0
        self._ends: dict[str, int] = {}  # number of the next item of each stream

    def changes(self, view: RobotView) -> Changes:
        changes = Changes({key: view.values[key] for key, number in view.versions.items() if number > self._version})
        for key in changes.values:
            self._version = max(self._version, view.versions[key])
        for key, stream in view.streams.items():
            end = self._ends.get(key, 0)
            if stream.end != end:
                changes.streams[key] = stream.since(end)
                self._ends[key] = stream.end
        return changes


class _KnownMap:
    """How far a viewer knows one map."""

    def __init__(self) -> None:
        self._lattice = 0
        self._version = 0
        self._due = -float("inf")
        self._behind = False

    def add(self, update: Update, robot: str, kind: str, tiled: TiledMap, now: float, period: float) -> None:
        """What is new of the map to the update, as far as there is room in it."""
        if now < self._due and not self._behind:
            return
        self._due = now + period
        if self._lattice != tiled.lattice_version:
            assert tiled.lattice is not None
            self._lattice, self._version = tiled.lattice_version, 0
            update.lattices.append((robot, kind, tiled.lattice))
        changed = tiled.changed_since(self._version, TILES - len(update.tiles))
        update.tiles += [(robot, kind, place, cells) for place, cells in changed.tiles]
        self._version = changed.version
        self._behind = changed.rest > 0
        update.rest += changed.rest
