"""Things of which only the newest are kept, with running numbers."""

from __future__ import annotations

import itertools
from collections import deque
from typing import Any, Sequence

LENGTHS = {  # kind of stream: items kept
    "trail": 5000,  # [x m, y m] in the robot's map frame
    "area": 2000,  # [s, m2]
    "traffic": 300,  # [s, octets/s sent, octets/s received]
    "events": 300,  # [s, kind, text, other robot or ""]
    "choices": 60,  # [s, x m, y m, reason, {robot: bid}, unit of the bids]
    "auctions": 300,  # [s, number, unit of the bids, [[x m, y m, {robot: bid}, robot that explores it or ""]]]
    "log": 200,  # [s, level, node, text]
}
TOLD = {"auctions": 50}  # kind of stream: items told at once, the newest; of the others all that are kept


class Stream:
    """The newest `length` items, of which `told` are told at once. `first` is the number of the oldest of them."""

    def __init__(self, length: int, told: int | None = None) -> None:
        self.first = 0
        self._told = length if told is None else told
        self._items: deque[Any] = deque(maxlen=length)

    @property
    def end(self) -> int:
        """Number of the next item."""
        return self.first + len(self._items)

    def append(self, item: Any) -> None:
        if len(self._items) == self._items.maxlen:
            self.first += 1
        self._items.append(item)

    def since(self, number: int, end: int | None = None) -> tuple[int, list[Any]]:
        """The items from that number on and before number `end`, as far as they are still there and told at once, and
        the number of the first of them."""
        end = self.end if end is None else end
        begin = min(max(number, self.first, end - self._told), end)
        return begin, list(itertools.islice(self._items, max(0, begin - self.first), max(0, end - self.first)))

    def extend(self, first: int, items: Sequence[Any]) -> None:
        """Items that begin with that number. What is known already is passed over; after a gap only the new ones
        are kept."""
        if first > self.end or first + len(items) < self.first:
            self._items.clear()
            self.first = first
        for item in items[max(0, self.end - first) :]:
            self.append(item)
