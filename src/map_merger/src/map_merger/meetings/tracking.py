"""Tracks: where the own robot was, where the objects were that it saw, and where another says that it was."""

import math
from typing import Dict, List, NamedTuple, Optional, Tuple

import numpy as np

HISTORY_S = 30.0
_MOST_SAMPLES = 240
_MOST_TRACKS = 16
"""Objects followed at a time; the nearest to the robot are kept."""
_MOST_ENDED = 24
_LOST_S = 1.0
_GATE_M = 0.25
_FASTEST = 1.5
"""m/s, of what is followed; faster things become new objects."""
_LONGEST_GAP_S = 0.7
_LONGEST_REST_S = 10.0
_REST_M = 0.05


class Fragment(NamedTuple):
    """Part of the way of one object. number: its own. samples: float (n, 3: time in s, x, y in m), oldest first."""

    number: int
    samples: np.ndarray


class Trail:
    """Timed rows of numbers, oldest first, at most HISTORY_S long and _MOST_SAMPLES many."""

    def __init__(self, columns: int, spacing: float) -> None:
        """columns: time and values. spacing: s, the least between two rows."""
        self._rows = np.empty((0, columns))
        self._spacing = spacing

    def add(self, row: Tuple[float, ...]) -> None:
        """A row that is older than the last one (the clock has jumped back) begins the trail anew."""
        time = row[0]
        if len(self._rows):
            last = float(self._rows[-1, 0])
            if time < last - self._spacing:
                self.clear()
            elif time - last < self._spacing - 1e-6:
                return
        rows = np.concatenate([self._rows, [row]])[-_MOST_SAMPLES:]
        self._rows = rows[rows[:, 0] >= time - HISTORY_S]

    def merge(self, rows: np.ndarray) -> None:
        """Adds rows that may be late, or known already."""
        rows = np.concatenate([self._rows, rows])
        _, first = np.unique(np.round(rows[:, 0] / self._spacing).astype(np.int64), return_index=True)
        rows = rows[np.sort(first)]
        rows = rows[np.argsort(rows[:, 0], kind="stable")][-_MOST_SAMPLES:]
        self._rows = rows[rows[:, 0] >= rows[-1, 0] - HISTORY_S] if len(rows) else rows

    def clear(self) -> None:
        """Forgets everything."""
        self._rows = self._rows[:0]

    @property
    def rows(self) -> np.ndarray:
        """Not to be changed."""
        return self._rows


def at_times(rows: np.ndarray, times: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Places as complex numbers (n,) of a trail (time, x, y, ...) at the given times, and whether they are known: not
    between rows far apart unless the robot rested."""
    if len(rows) < 2:
        return np.zeros(len(times), complex), np.zeros(len(times), bool)
    after = np.minimum(np.maximum(np.searchsorted(rows[:, 0], times), 1), len(rows) - 1)
    before = after - 1
    start, span = rows[before, 0], rows[after, 0] - rows[before, 0]
    share = np.minimum(np.maximum((times - start) / np.maximum(span, 1e-9), 0.0), 1.0)
    place = rows[:, 1] + 1j * rows[:, 2]
    moved = place[after] - place[before]
    rests = (np.abs(moved) < _REST_M) & (span <= _LONGEST_REST_S)
    inside = (times >= rows[0, 0] - 0.05) & (times <= rows[-1, 0] + 0.05)
    return place[before] + share * moved, inside & ((span <= _LONGEST_GAP_S) | rests)


class _Followed:
    """One object."""

    def __init__(self, number: int, time: float, place: complex) -> None:
        self.number = number
        self.samples: List[Tuple[float, float, float]] = [(time, place.real, place.imag)]
        self.place, self.velocity, self.time = place, 0j, time

    def predicted(self, now: float) -> complex:
        return self.place + self.velocity * min(now - self.time, 0.5)

    def take(self, now: float, place: complex) -> None:
        step = max(now - self.time, 1e-3)
        self.velocity = 0.5 * self.velocity + 0.5 * (place - self.place) / step
        if abs(self.velocity) > _FASTEST:
            self.velocity *= _FASTEST / abs(self.velocity)
        self.place, self.time = place, now
        self.samples.append((now, place.real, place.imag))
        if len(self.samples) > _MOST_SAMPLES:
            del self.samples[0]


class ObjectTracks:
    """Follows objects from scan to scan: each takes the nearest one that it can have become."""

    def __init__(self) -> None:
        self._followed: List[_Followed] = []
        self._ended: List[Fragment] = []
        self._count = 0
        self._time = -math.inf

    def clear(self) -> None:
        """Forgets everything but the numbers, which are never used twice."""
        self._followed, self._ended, self._time = [], [], -math.inf

    def take(self, now: float, centres: np.ndarray) -> None:
        """centres: float (n, 2), m, of all objects seen now, nearest to the robot first."""
        if now < self._time:
            self.clear()
        self._time = now
        self._end_lost(now)
        places = [complex(x, y) for x, y in centres.tolist()]
        for each, index in self._assigned(now, places):
            each.take(now, places[index])
            places[index] = complex(math.nan)
        for place in places:
            if place == place and len(self._followed) < _MOST_TRACKS:
                self._count += 1
                self._followed.append(_Followed(self._count, now, place))

    def _assigned(self, now: float, places: List[complex]) -> List[Tuple[_Followed, int]]:
        pairs: List[Tuple[float, int, _Followed, int]] = []
        for each in self._followed:
            gate = _GATE_M + _FASTEST * 0.3 * min(now - each.time, 1.0)
            predicted = each.predicted(now)
            for index, place in enumerate(places):
                distance = abs(place - predicted)
                if distance <= gate:
                    pairs.append((distance, len(pairs), each, index))
        taken: Dict[int, bool] = {}
        result = []
        for _, _, each, index in sorted(pairs, key=lambda pair: pair[:2]):
            if each.time < now and index not in taken and id(each) not in taken:
                taken[index] = taken[id(each)] = True
                result.append((each, index))
        return result

    def _end_lost(self, now: float) -> None:
        for each in self._followed:
            if now - each.time > _LOST_S and len(each.samples) > 2:
                self._ended.append(Fragment(each.number, np.array(each.samples)))
        self._followed = [each for each in self._followed if now - each.time <= _LOST_S]
        self._ended = [each for each in self._ended if each.samples[-1, 0] >= now - HISTORY_S][-_MOST_ENDED:]

    def fragments(self, now: float) -> Tuple[Fragment, ...]:
        """All ways known of the last HISTORY_S."""
        present = []
        for each in self._followed:
            samples = np.array(each.samples)
            present.append(Fragment(each.number, samples[samples[:, 0] >= now - HISTORY_S]))
        return tuple(self._ended) + tuple(present)

    def present(self) -> Tuple[Fragment, ...]:
        """Those in sight."""
        return tuple(Fragment(each.number, np.array(each.samples)) for each in self._followed)


def moves(samples: np.ndarray, distance: float) -> bool:
    """True if places (n, 3: time, x, y) lie farther apart than `distance`, in m."""
    if len(samples) < 2:
        return False
    return bool(np.hypot(*(samples[:, 1:3].max(axis=0) - samples[:, 1:3].min(axis=0))) > distance)


def last_of(rows: np.ndarray) -> Optional[np.ndarray]:
    """The latest row, if there is one."""
    return rows[-1] if len(rows) else None
