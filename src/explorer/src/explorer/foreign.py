"""Frontier points as they travel between robots, and those that others have reported."""

import math
from dataclasses import dataclass
from itertools import chain
from typing import Dict, List, Optional, Sequence, Tuple

import numpy as np

from explorer._kernels import within_any
from mr_grid import is_place

# Points of one robot that are kept.
MAXIMUM_POINTS = 4000

# Robots whose points and mission are remembered, those that came last.
REMEMBERED_ROBOTS = 200

Key = Tuple[str, int]


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


class ForeignFrontiers:
    """Frontier points that other robots have reported, per detecting robot, bounded, newest kept.

    Coordinates stay in the detector's map frame; `in_own_frame` applies the newest transform, so that a refined
    transform takes effect at once. Without a transform a robot's points do not take part.
    """

    def __init__(self, maximum_per_robot: int = MAXIMUM_POINTS) -> None:
        self._maximum = maximum_per_robot
        self._points: Dict[str, Dict[int, Tuple[float, float]]] = {}
        self._places: Dict[str, np.ndarray] = {}  # the same as (n, 2) arrays, made when they are asked for
        self._own: Dict[str, Dict[int, Tuple[float, float]]] = {}  # of the same in the own frame, those asked for
        self._transforms: Dict[str, Tuple[float, ...]] = {}
        self._missions: Dict[str, int] = {}
        self.revision = 0  # counts the changes
        self.transform_revision = 0  # counts those of transforms

    def add(self, element: Element) -> None:
        points = self._points.setdefault(element.detected_by, {})
        points.pop(element.number, None)
        self._changed(element.detected_by, element.number)
        points[element.number] = (element.x, element.y)
        if len(points) > self._maximum:
            oldest = next(iter(points))
            del points[oldest]
            self._own.get(element.detected_by, {}).pop(oldest, None)
        if len(self._points) > REMEMBERED_ROBOTS:
            first = next(iter(self._points))
            del self._points[first]
            self._all_changed(first)

    def take_mission(self, robot: str, mission: int) -> None:
        """The mission that a robot is on. With another one than before its points are gone: an explorer that was
        started anew counts them from the start again."""
        if self._missions.get(robot, mission) != mission and robot in self._points:
            del self._points[robot]
            self._all_changed(robot)
        self._missions.pop(robot, None)
        self._missions[robot] = mission
        if len(self._missions) > REMEMBERED_ROBOTS:
            del self._missions[next(iter(self._missions))]

    def remove(self, key: Key) -> None:
        self._points.get(key[0], {}).pop(key[1], None)
        self._changed(*key)

    def _changed(self, robot: str, number: int) -> None:
        self._places.pop(robot, None)
        self._own.get(robot, {}).pop(number, None)
        self.revision += 1

    def _all_changed(self, robot: str) -> None:
        self._places.pop(robot, None)
        self._own.pop(robot, None)
        self.revision += 1

    def set_transform(self, robot: str, transform: Optional[np.ndarray]) -> None:
        """`transform`: (2, 3) array from the robot's map frame to the own one in metres; None: not known."""
        self.revision += 1
        rows = None if transform is None else tuple(np.asarray(transform, dtype=float).reshape(6).tolist())
        if rows != self._transforms.get(robot):
            self.transform_revision += 1
            self._own.pop(robot, None)
        if rows is None:
            self._transforms.pop(robot, None)
        else:
            self._transforms[robot] = rows

    def forget_transforms(self) -> None:
        """The own map frame is another one."""
        for robot in list(self._transforms):
            self.set_transform(robot, None)

    def has_transform(self, robot: str) -> bool:
        return robot in self._transforms

    def robots(self) -> List[str]:
        return sorted(self._points)

    def have_near(self, elements: Sequence[Element], radius: float) -> List[bool]:
        """For each of them, whether its detector has reported a point within `radius` metres of it that is still
        there."""
        near = [False] * len(elements)
        for robot in {element.detected_by for element in elements} & self._points.keys():
            rows = [row for row, element in enumerate(elements) if element.detected_by == robot]
            places = np.array([(elements[row].x, elements[row].y) for row in rows])
            for row, found in zip(rows, within_any(places, self._places_of(robot), radius).tolist()):
                near[row] = found
        return near

    def _places_of(self, robot: str) -> np.ndarray:
        places = self._places.get(robot)
        if places is None:
            points = self._points[robot]
            numbers = np.fromiter(chain.from_iterable(points.values()), dtype=float, count=2 * len(points))
            places = self._places[robot] = numbers.reshape(-1, 2)
        return places

    def count(self) -> int:
        return sum(len(points) for points in self._points.values())

    def places(self, robot: str) -> List[Tuple[float, float]]:
        """Points of a robot in metres in the own map frame; none without a transform."""
        return self.in_own_frame([(robot, number) for number in self._points.get(robot, {})])

    def to_own_frame(self, element: Element) -> Optional[Tuple[float, float]]:
        transform = self._transforms.get(element.detected_by)
        if transform is None:
            return None
        return _transformed(transform, element.x, element.y)

    def in_own_frame(self, keys: Sequence[Key]) -> List[Tuple[float, float]]:
        """(x, y) in metres in the own map frame of those points that are known, with their transform."""
        places = []
        placed = self._transforms.keys() & self._points.keys()
        robots = {robot: self._own.setdefault(robot, {}) for robot in placed.intersection(robot for robot, _ in keys)}
        for robot, number in keys:
            known = robots.get(robot)
            if known is None:
                continue
            place = known.get(number)
            if place is None:
                point = self._points[robot].get(number)
                if point is None:
                    continue
                place = known[number] = _transformed(self._transforms[robot], *point)
            places.append(place)
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
