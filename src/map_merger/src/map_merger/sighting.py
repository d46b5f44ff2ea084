"""Robots that see one another: the one kind of evidence for a transform that no copy of a room can fake.

A robot is an obstacle in the maps of the others: it stands where it says it is, and the place is free once it has left.
Views of the times at which places were told are kept: whether they show the robot can be said once a transform is
proposed.
"""

import math
from collections import deque
from typing import Deque, List, NamedTuple, Sequence, Tuple

import numpy as np

from .grid import OCCUPIED_FROM, UNKNOWN, Grid, cell_centres, values_at
from .transform import Transform

LONGEST_LAG_S = 2.0
"""A place and an own map belong together if they are at most so many seconds apart."""
LONGEST_MAP_LAG_S = 6.0
"""The same for another robot's map, which comes in parts and late."""
BODY_M = 0.3
"""The visible sides of a robot are at most this far from its reference point."""
LEFT_M = 0.7
"""A robot that is farther than this from a place has left it."""
_SEEN_M = 0.25
"""Metres of obstacle (cells times their side) around the reference point that show a robot."""
_FREE_SHARE = 0.8
"""Share of the cells of a place that must be known as free for the place to be empty."""
_FIRST, _LAST = 6, 18
_SHORTEST_MOVE_M = 0.1


class View(NamedTuple):
    """What a map showed: the centres of its occupied cells (float32, (n, 2), m, in the map's frame) and their side."""

    obstacles: np.ndarray
    resolution: float


class Sighting(NamedTuple):
    """A view, and where the other robot said it was at that time (m, in that robot's map frame)."""

    view: View
    x: float
    y: float


def view_of(grid: Grid) -> View:
    """What the map shows."""
    return View(cell_centres(grid.info, *np.nonzero(grid.occupied)).astype(np.float32), grid.info.resolution)


class Views:
    """Sightings of one robot: the first ones, when robots stand together before they set off, and the latest."""

    def __init__(self) -> None:
        self._first: List[Sighting] = []
        self._last: Deque[Sighting] = deque(maxlen=_LAST)

    def add(self, sighting: Sighting) -> None:
        """Keeps the sighting unless it repeats one that is kept."""
        if any(
            known.view is sighting.view and math.hypot(known.x - sighting.x, known.y - sighting.y) < _SHORTEST_MOVE_M
            for known in self._kept()
        ):
            return
        if len(self._first) < _FIRST:
            self._first.append(sighting)
        else:
            self._last.append(sighting)

    def all(self) -> Tuple[Sighting, ...]:
        """Oldest first."""
        return tuple(self._kept())

    def _kept(self) -> List[Sighting]:
        return self._first + list(self._last)


def robot_seen(present: Grid, sightings: Sequence[Sighting], track: np.ndarray, transform: Transform) -> bool:
    """True if a view shows the other robot where it said it was, and the map shows that place empty now that the robot
    has left it.

    present: the latest map of the viewer. track: places (n, 2) of the other robot in metres in its frame, the latest
    last. transform: from the other robot's frame to the viewer's.
    """
    if not len(track):
        return False
    left = [each for each in sightings if math.hypot(track[-1, 0] - each.x, track[-1, 1] - each.y) >= LEFT_M]
    places = transform.apply(np.array([[each.x, each.y] for each in left]).reshape(-1, 2))
    return any(_shows(each.view, place) and _is_empty(present, place) for each, place in zip(left, places))


def _shows(view: View, place: np.ndarray) -> bool:
    near = np.hypot(view.obstacles[:, 0] - place[0], view.obstacles[:, 1] - place[1]) <= BODY_M
    return float(near.sum()) * view.resolution >= _SEEN_M


def _is_empty(grid: Grid, place: np.ndarray) -> bool:
    count = math.ceil(BODY_M / grid.info.resolution)
    steps = np.arange(-count, count + 1) * grid.info.resolution
    offsets = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    cells = values_at(grid.cells, grid.info, offsets[np.hypot(*offsets.T) <= BODY_M] + place, UNKNOWN)
    return not (cells >= OCCUPIED_FROM).any() and float((cells != UNKNOWN).mean()) >= _FREE_SHARE
