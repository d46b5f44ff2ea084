"""What a page shows of a team: values, streams and maps of each robot. Knows no ROS, no socket and no clock."""

from __future__ import annotations

import itertools
from typing import Any, Iterator

from mr_page.stream import LENGTHS, TOLD, Stream
from mr_page.tiles import TiledMap
from mr_page.update import Update

MAX_ROBOTS = 64
MAX_VALUES = 64  # of one robot
MAPS = ("local", "global")  # kinds of maps of a robot
TEAM = ""  # the name under which values of the whole page are kept


class RobotView:
    """What is known of one run of a robot. Values are plain JSON and have the version of their last change."""

    def __init__(self, clock: Iterator[int]) -> None:
        self.run = next(clock)
        self.values: dict[str, Any] = {}
        self.versions: dict[str, int] = {}
        self.streams: dict[str, Stream] = {}
        self.maps = {kind: TiledMap(lambda: next(clock)) for kind in MAPS}


class PageState:
    """The owner of all that pages show. Everything in it is bounded; robots beyond MAX_ROBOTS are not taken."""

    def __init__(self) -> None:
        self.robots: dict[str, RobotView] = {}
        self._clock = itertools.count(1)

    def robot(self, name: str) -> RobotView:
        """The view of a robot, made when it is new. ValueError if there are too many."""
        if name not in self.robots:
            if len(self.robots) >= MAX_ROBOTS:
                raise ValueError(f"a page shows {MAX_ROBOTS} robots, {name!r} is one more")
            self.robots[name] = RobotView(self._clock)
        return self.robots[name]

    def forget(self, robot: str) -> None:
        """Drop all that is known of a robot; what comes next is a new run of it."""
        self.robots.pop(robot, None)

    def put(self, robot: str, name: str, value: Any) -> None:
        """A value of plain JSON; nothing changes if it is as before. ValueError for one name too many."""
        view = self.robot(robot)
        if name in view.values and view.values[name] == value:
            return
        if name not in view.values and len(view.values) >= MAX_VALUES:
            raise ValueError(f"a page shows {MAX_VALUES} values of a robot, {name!r} is one more")
        view.values[name] = value
        view.versions[name] = next(self._clock)

    def get(self, robot: str, name: str, default: Any = None) -> Any:
        view = self.robots.get(robot)
        return default if view is None else view.values.get(name, default)

    def append(self, robot: str, stream: str, item: Any) -> None:
        self.stream(robot, stream).append(item)

    def stream(self, robot: str, name: str) -> Stream:
        """KeyError for a kind of stream that there is not."""
        streams = self.robot(robot).streams
        if name not in streams:
            streams[name] = Stream(LENGTHS[name], TOLD.get(name))
        return streams[name]

    def map(self, robot: str, kind: str) -> TiledMap:
        """KeyError for a kind of map that there is not."""
        return self.robot(robot).maps[kind]

    def apply(self, update: Update) -> None:
        """What another PageState has told. ValueError or KeyError for what it cannot have told."""
        for name in update.anew:
            self.forget(name)
        for name, part in update.robots.items():
            for key, value in part.values.items():
                self.put(name, key, value)
            for key, (first, items) in part.streams.items():
                self.stream(name, key).extend(first, items)
        for robot, kind, lattice in update.lattices:
            self.map(robot, kind).restart(lattice)
        for robot, kind, place, cells in update.tiles:
            self.map(robot, kind).set(place, cells)
