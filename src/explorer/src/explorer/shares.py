"""Stops shared out among robots, each with an open tour of its own: cheapest insertion, then stops change places."""

import math
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

# Tours count by this power of their length: 1 would leave all to one robot, infinity looks at the longest alone.
# Tuned with the weights of strategy 7.
POWER = 3.0
MAXIMUM_ROUNDS = 6  # over all stops, of which each may change its place
LEAST_GAIN = 1e-6  # relative to what the tours count, for which a stop changes its place

Tour = List[int]


class Errand(NamedTuple):
    """`starts`: (robots, stops) way of each robot to each stop, infinite where it cannot go; `between`: (stops, stops)
    ways; `service`: (stops,) what a stop costs by itself, all in metres. `first`: the stop that each robot is sure to
    go to before others, if any; no two the same."""

    starts: np.ndarray
    between: np.ndarray
    service: np.ndarray
    first: Sequence[Optional[int]]


def share_out(errand: Errand) -> List[Tour]:
    """The tour of each robot, in order. A stop that no robot reaches is in none."""
    tours = _Tours(errand)
    taken = {stop for stop in errand.first if stop is not None}
    tours.insert_all([stop for stop in range(len(errand.service)) if stop not in taken])
    for _ in range(MAXIMUM_ROUNDS):
        if not tours.move():
            break
    return tours.tours


class _Place(NamedTuple):
    """Where a stop could go: `more` that the tours would count, as number `at` of a robot's tour."""

    more: float
    robot: int
    at: int


class _Tours:
    def __init__(self, errand: Errand) -> None:
        self._starts, self._between = errand.starts.tolist(), errand.between.tolist()
        self._service, self._first = errand.service.tolist(), list(errand.first)
        self.tours: List[Tour] = [[] if stop is None else [stop] for stop in errand.first]
        self._lengths = [self._length(robot) for robot in range(len(self.tours))]

    def insert_all(self, free: List[int]) -> None:
        """Each time the stop that costs least where it costs least."""
        robots = range(len(self.tours))
        places = {stop: [self._place(stop, robot) for robot in robots] for stop in free}
        while places:
            best, stop = min((min(options), stop) for stop, options in places.items())
            if not math.isfinite(best.more):
                return
            del places[stop]
            self._insert(stop, best)
            for other, options in places.items():
                options[best.robot] = self._place(other, best.robot)

    def move(self) -> bool:
        """Moves stops to where they cost less; False if none did."""
        better = False
        for robot, stop in [(robot, stop) for robot, tour in enumerate(self.tours) for stop in tour]:
            if stop not in self.tours[robot] or self._first[robot] == stop:
                continue
            index = self.tours[robot].index(stop)
            before = self._lengths[robot] ** POWER
            self.tours[robot].remove(stop)
            self._lengths[robot] = self._length(robot)
            saved = before - self._lengths[robot] ** POWER
            best = min(self._place(stop, other) for other in range(len(self.tours)))
            gains = best.more < saved - LEAST_GAIN * max(1.0, before)
            better = better or gains
            self._insert(stop, best if gains else _Place(saved, robot, index))
        return better

    def _insert(self, stop: int, place: _Place) -> None:
        self.tours[place.robot].insert(place.at, stop)
        self._lengths[place.robot] = self._length(place.robot)

    def _length(self, robot: int) -> float:
        tour = self.tours[robot]
        ways = [self._between[here][there] for here, there in zip(tour, tour[1:])]
        return sum(ways) + sum(self._service[stop] for stop in tour) + (self._starts[robot][tour[0]] if tour else 0.0)

    def _place(self, stop: int, robot: int) -> _Place:
        """The best one in a robot's tour."""
        earliest = 0 if self._first[robot] is None else 1
        longer, index = min((self._detour(stop, robot, at), at) for at in range(earliest, len(self.tours[robot]) + 1))
        length = self._lengths[robot]
        return _Place((length + longer + self._service[stop]) ** POWER - length**POWER, robot, index)

    def _detour(self, stop: int, robot: int, index: int) -> float:
        tour: Sequence[int] = self.tours[robot]
        from_here = self._starts[robot] if index == 0 else self._between[tour[index - 1]]
        if index == len(tour):
            return float(from_here[stop])
        return float(max(0.0, from_here[stop] + self._between[stop][tour[index]] - from_here[tour[index]]))


def arrivals(errand: Errand, robot: int, tour: Sequence[int]) -> List[Tuple[int, float]]:
    """(stop, metres that the robot has driven and spent on stops when it comes there) along a tour."""
    result, spent = [], 0.0
    for index, stop in enumerate(tour):
        spent += float(errand.starts[robot, stop] if index == 0 else errand.between[tour[index - 1], stop])
        result.append((stop, spent))
        spent += float(errand.service[stop])
    return result
