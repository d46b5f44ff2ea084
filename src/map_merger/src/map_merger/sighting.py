"""Robots that see one another: evidence for a transform that walls alone, which may be those of a copy, cannot give.

A robot is an obstacle in the maps of the others: it stands where it says it is, and the place is free once it has left.
Views of the times at which places were told are kept: whether they show the robot can be said once a transform is
proposed. A third robot may stand at such a place in a copy of the room. So where another robot of the team was nothing
counts, and as long as it is not known where each of them was, two places are needed.
"""

import math
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from mr_grid import UNKNOWN, OccupancyGrid, Pose, values_at

from .grid import OCCUPIED_FROM, occupied_cells
from .robot_size import RobotSize

LONGEST_LAG_S = 2.0
"""A place and an own map belong together if they are at most so many seconds apart."""
LONGEST_MAP_LAG_S = 6.0
"""The same for another robot's map, which comes in parts and late."""
SIGHTINGS_NEEDED = 2
"""Places, counted in both directions, that are a meeting while another robot of the team may be anywhere; else one."""
_SEEN_M = 0.25
"""Metres of obstacle (cells times their side) around the reference point that show a robot and are gone afterwards."""
_REMAINS_M = 0.15
"""Metres of obstacle that the map may keep there: single cells are wiped late."""
_KNOWN_SHARE = 0.8
"""Share of the cells of a place that must be known for the place to be empty."""
SIGHT_M = 10.0
"""Farther away a robot covers too few cells."""
_FIRST, _LAST = 12, 120
_SHORTEST_MOVE_M = 0.15


class View(NamedTuple):
    """What a map showed: the centres of its occupied cells (float32, (n, 2), m, in the map's frame) and their side."""

    obstacles: np.ndarray
    resolution: float


class Sighting(NamedTuple):
    """A view, and where the other robot said it was at that time (m, in that robot's map frame; s)."""

    view: View
    x: float
    y: float
    time: float


def view_of(grid: OccupancyGrid, viewer: Optional[Pose]) -> View:
    """What the map shows within SIGHT_M of the viewer, or everywhere if its pose is not known."""
    centres = grid.info.centres(*np.nonzero(occupied_cells(grid)))
    if viewer is not None:
        centres = centres[np.hypot(centres[:, 0] - viewer.x, centres[:, 1] - viewer.y) <= SIGHT_M]
    return View(centres.astype(np.float32), grid.info.resolution)


class Views:
    """Sightings of one robot: the first ones, when robots stand together before they set off, and the latest. While the
    robot stands, only the latest of them."""

    def __init__(self) -> None:
        self._kept: List[Sighting] = []

    def add(self, sighting: Sighting) -> None:
        """Keeps the sighting unless its view has one at that place."""
        if any(known.view is sighting.view and _same_place(known, sighting) for known in self._kept):
            return
        if len(self._kept) > _FIRST and all(_same_place(known, sighting) for known in self._kept[-2:]):
            del self._kept[-1]
        self._kept.append(sighting)
        if len(self._kept) > _FIRST + _LAST:
            del self._kept[_FIRST]

    def all(self) -> Tuple[Sighting, ...]:
        """Oldest first."""
        return tuple(self._kept)


def _same_place(first: Sighting, second: Sighting) -> bool:
    return math.hypot(first.x - second.x, first.y - second.y) < _SHORTEST_MOVE_M


def nowhere() -> np.ndarray:
    """No places."""
    return np.empty((0, 3))


def moved(track: np.ndarray, transform: Pose) -> np.ndarray:
    """The places (n, 3: x, y, time) of a track in another frame."""
    return np.column_stack([transform.apply(track[:, :2]), track[:, 2]])


def places_seen(
    present: OccupancyGrid,
    sightings: Sequence[Sighting],
    track: np.ndarray,
    transform: Pose,
    others: np.ndarray,
    size: RobotSize,
) -> int:
    """At how many places, `size.left` apart, a view shows the other robot where it said it was, and the map shows that
    place empty now that the robot has left it.

    present: the latest map of the viewer. track: places (n, 3: x, y, time) of the other robot in its frame, the latest
    last. transform: from the other robot's frame to the viewer's. others: places (n, 3) of all further robots, as far
    as known, in the viewer's frame; a view is not counted where one of them was until then.
    """
    counted: List[Sighting] = []
    for each in sightings:
        if not len(track) or any(math.hypot(each.x - other.x, each.y - other.y) < size.left for other in counted):
            continue
        place = transform.apply_point(each.x, each.y)
        if (
            math.hypot(track[-1, 0] - each.x, track[-1, 1] - each.y) >= size.left
            and not _may_be_another(each, place, others, size)
            and _came_and_went(each.view, present, place, size.visible)
        ):
            counted.append(each)
    return len(counted)


def _may_be_another(sighting: Sighting, place: Tuple[float, float], others: np.ndarray, size: RobotSize) -> bool:
    near = np.hypot(others[:, 0] - place[0], others[:, 1] - place[1]) <= 2.0 * size.visible
    return bool((others[near, 2] <= sighting.time + LONGEST_LAG_S).any())


def _came_and_went(view: View, present: OccupancyGrid, place: Tuple[float, float], body: float) -> bool:
    shown = np.hypot(view.obstacles[:, 0] - place[0], view.obstacles[:, 1] - place[1]) <= body
    cells = _cells_around(present, place, body)
    remains = int((cells >= OCCUPIED_FROM).sum())
    return (
        (int(shown.sum()) - remains) * view.resolution >= _SEEN_M - 1e-9
        and remains * present.info.resolution <= _REMAINS_M + 1e-9
        and float((cells != UNKNOWN).mean()) >= _KNOWN_SHARE
    )


def _cells_around(grid: OccupancyGrid, place: Tuple[float, float], body: float) -> np.ndarray:
    count = math.ceil(body / grid.info.resolution)
    steps = np.arange(-count, count + 1) * grid.info.resolution
    offsets = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    return values_at(grid.cells, grid.info, offsets[np.hypot(*offsets.T) <= body] + place, UNKNOWN)
