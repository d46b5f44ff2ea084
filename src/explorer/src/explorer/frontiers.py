"""Frontiers: free cells next to unknown ones (Yamauchi 1997), thinned to points that keep their identity."""

import math
from dataclasses import dataclass, field
from typing import Dict, List, Optional, Sequence, Tuple

import cv2
import numpy as np

from explorer import _kernels
from explorer.grid import OccupancyMap, is_place

# Half edge in metres of the box in which two frontier points count as one (contract 3.4).
THINNING_DISTANCE = 0.2

# Unknown islands smaller than this, in square metres, are gaps between laser beams, not places to go to.
SMALLEST_UNKNOWN_AREA = 0.04

# Points that were given up or visited, kept so that a point found there anew inherits the verdict.
MAXIMUM_SPOTS = 2000

# Points beyond this number are not stored: bounds messages and computing time on a noisy map.
MAXIMUM_FRONTIERS = 4000

Key = Tuple[str, int]


@dataclass
class Frontier:
    """A frontier point of this robot, in metres in its map frame.

    `visited`: it was looked at from close by and is still there, so it is no longer a goal. `failures` counts the
    goals that failed, `blocked` those that failed behind another robot; until `retry_at` it is not tried again, after
    `given_up` only when the map around it changed.
    """

    number: int
    x: float
    y: float
    visited: bool = False
    given_up: bool = False
    failures: int = 0
    blocked: int = 0
    retry_at: float = -math.inf
    hidden_until: float = -math.inf
    looks: int = 0


@dataclass(frozen=True)
class Element:
    """A frontier point as it travels: position in metres in the map frame of the robot that detected it."""

    detected_by: str
    number: int
    x: float
    y: float

    @property
    def key(self) -> Key:
        return (self.detected_by, self.number)


def frontier_cells(occupancy: OccupancyMap, minimal_length: float) -> np.ndarray:
    """(height, width) bool array of the frontier cells of a map.

    A frontier cell is free, has an unknown cell among its 8 neighbours and no occupied one. Unknown islands below
    `SMALLEST_UNKNOWN_AREA` make no frontier, and connected frontiers shorter than `minimal_length` metres are noise.
    """
    resolution = occupancy.info.resolution
    return _kernels.frontier_cells(
        occupancy.cells,
        occupancy.FREE_BELOW,
        occupancy.OCCUPIED_FROM,
        max(1, int(SMALLEST_UNKNOWN_AREA / resolution**2)),
        _cells_of_length(minimal_length, resolution),
    )


def _cells_of_length(length: float, resolution: float) -> int:
    """The least number of cells that are at least as long, both in metres."""
    count = max(0, math.floor(length / resolution) - 1)
    while count * resolution < length:
        count += 1
    return count


def thin(points: np.ndarray, distance: float = THINNING_DISTANCE) -> np.ndarray:
    """Subset of an (n, 2) array of points in metres: each point left out has one of the subset within the box of
    half edge `distance`, no two of the subset lie in each other's box. Deterministic, first come first kept."""
    points = np.asarray(points, dtype=float).reshape(-1, 2)
    return points[_kernels.thin(points, distance)]


@dataclass
class FrontierStore:
    """The frontier points of this robot. A point keeps its number as long as a frontier cell is in its box."""

    first_number: int = 0
    frontiers: Dict[int, Frontier] = field(default_factory=dict)
    _count: int = 0
    _spots: List[Frontier] = field(default_factory=list)

    def update(self, occupancy: OccupancyMap, cells: np.ndarray) -> Tuple[List[Frontier], List[Frontier]]:
        """Takes the frontier cells of a new map (bool array of the map's shape); returns points new and gone."""
        gone = self._drop_vanished(occupancy, cells)
        new = self._add_uncovered(occupancy, cells)
        return new, gone

    def clear(self) -> None:
        """Forgets all points and verdicts; new points get new numbers."""
        self.frontiers.clear()
        self._spots.clear()

    def ordered(self) -> List[Frontier]:
        return [self.frontiers[number] for number in sorted(self.frontiers)]

    def _drop_vanished(self, occupancy: OccupancyMap, cells: np.ndarray) -> List[Frontier]:
        reach = max(1, int(THINNING_DISTANCE / occupancy.info.resolution))
        near = _box_dilate(cells, reach)
        gone = []
        for frontier in self.ordered():
            row, col = occupancy.info.cell_of(frontier.x, frontier.y)
            if not (occupancy.info.contains(row, col) and near[row, col]):
                gone.append(frontier)
                del self.frontiers[frontier.number]
                if frontier.visited or frontier.given_up:
                    self._remember(frontier)
        return gone

    def _add_uncovered(self, occupancy: OccupancyMap, cells: np.ndarray) -> List[Frontier]:
        stored = self.ordered()
        covered = np.zeros(cells.shape, dtype=bool)
        if stored:
            own = occupancy.info.cells_of(np.array([(f.x, f.y) for f in stored]))
            own = own[occupancy.info.inside(own)]
            covered[own[:, 0], own[:, 1]] = True
            covered = _box_dilate(covered, max(1, int(THINNING_DISTANCE / occupancy.info.resolution)))
        # Several times faster than looking for them in two dimensions.
        open_cells = np.column_stack(np.divmod(np.flatnonzero(cells & ~covered), cells.shape[1]))
        new = []
        for x, y in thin(occupancy.info.centres_of(open_cells)).tolist():
            if len(self.frontiers) >= MAXIMUM_FRONTIERS:
                break
            frontier = self._with_verdict(Frontier(self.first_number + self._count, x, y))
            self._count += 1
            self.frontiers[frontier.number] = frontier
            new.append(frontier)
        return new

    def _remember(self, frontier: Frontier) -> None:
        self._spots.append(frontier)
        del self._spots[:-MAXIMUM_SPOTS]

    def _with_verdict(self, frontier: Frontier) -> Frontier:
        for spot in reversed(self._spots):
            if abs(spot.x - frontier.x) < THINNING_DISTANCE and abs(spot.y - frontier.y) < THINNING_DISTANCE:
                frontier.visited, frontier.given_up = spot.visited, spot.given_up
                frontier.failures, frontier.blocked = spot.failures, spot.blocked
                frontier.retry_at = spot.retry_at
                break
        return frontier


def _box_dilate(mask: np.ndarray, reach: int) -> np.ndarray:
    return cv2.dilate(mask.view(np.uint8), np.ones((2 * reach + 1, 2 * reach + 1), dtype=np.uint8)) > 0


class ForeignFrontiers:
    """Frontier points that other robots have reported, per detecting robot, bounded, newest kept.

    Coordinates stay in the detector's map frame; `in_own_frame` applies the newest transform at every call, so that
    a refined transform takes effect at once. Without a transform a robot's points do not take part.
    """

    def __init__(self, maximum_per_robot: int = MAXIMUM_FRONTIERS) -> None:
        self._maximum = maximum_per_robot
        self._points: Dict[str, Dict[int, Tuple[float, float]]] = {}
        self._transforms: Dict[str, Tuple[float, ...]] = {}

    def add(self, element: Element) -> None:
        points = self._points.setdefault(element.detected_by, {})
        points.pop(element.number, None)
        points[element.number] = (element.x, element.y)
        while len(points) > self._maximum:
            del points[next(iter(points))]

    def remove(self, key: Key) -> None:
        self._points.get(key[0], {}).pop(key[1], None)

    def set_transform(self, robot: str, transform: Optional[np.ndarray]) -> None:
        """`transform`: (2, 3) array from the robot's map frame to the own one in metres; None: not known."""
        if transform is None:
            self._transforms.pop(robot, None)
        else:
            self._transforms[robot] = tuple(np.asarray(transform, dtype=float).reshape(6).tolist())

    def has_transform(self, robot: str) -> bool:
        return robot in self._transforms

    def robots(self) -> List[str]:
        return sorted(self._points)

    def count(self) -> int:
        return sum(len(points) for points in self._points.values())

    def places(self, robot: str) -> List[Tuple[float, float]]:
        """Points of a robot in metres in the own map frame; none without a transform."""
        return self.all_in_own_frame([(robot, number) for number in self._points.get(robot, {})])

    def to_own_frame(self, element: Element) -> Optional[Tuple[float, float]]:
        transform = self._transforms.get(element.detected_by)
        if transform is None:
            return None
        return _transformed(transform, element.x, element.y)

    def in_own_frame(self, key: Key) -> Optional[Tuple[float, float]]:
        """(x, y) in metres in the own map frame, or None if the point or the transform is not known."""
        places = self.all_in_own_frame([key])
        return places[0] if places else None

    def all_in_own_frame(self, keys: Sequence[Key]) -> List[Tuple[float, float]]:
        """(x, y) in metres in the own map frame of those points that are known, with their transform."""
        points, transforms, places = self._points, self._transforms, []
        for robot, number in keys:
            transform = transforms.get(robot)
            if transform is not None and robot in points:
                point = points[robot].get(number)
                if point is not None:
                    places.append(_transformed(transform, *point))
        return places


def _transformed(transform: Tuple[float, ...], x: float, y: float) -> Tuple[float, float]:
    """A point in metres under the rows of a (2, 3) transform."""
    a, b, c, d, e, f = transform
    return (a * x + b * y + c, d * x + e * y + f)


def rigid_transform(points: np.ndarray, images: np.ndarray) -> Optional[np.ndarray]:
    """(2, 3) rotation and translation that maps (n, 2) points to their (n, 2) images in least squares (Kabsch);
    None if the images are not a rigid copy of the points within 5 % of their spread."""
    points, images = np.asarray(points, dtype=float), np.asarray(images, dtype=float)
    if len(points) < 2 or not is_place(*images.ravel()):
        return None
    a, b = points - points.mean(axis=0), images - images.mean(axis=0)
    angle = math.atan2(float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()), float((a * b).sum()))
    rotation = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    if np.abs(a @ rotation.T - b).max() > 0.05 * np.abs(a).max():
        return None
    shift = images.mean(axis=0) - rotation @ points.mean(axis=0)
    return np.hstack([rotation, shift[:, None]])
