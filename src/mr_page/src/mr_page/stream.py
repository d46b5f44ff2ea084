"""Things of which only the newest are kept, with running numbers."""

from __future__ import annotations

from collections import deque
from typing import Any, Sequence

LENGTHS = {  # kind of stream: items kept
    "trail": 5000,  # [x m, y m] in the robot's map frame
    "area": 2000,  # [s, m2]
    "traffic": 300,  # [s, octets/s sent, octets/s received]
    "events": 300,  # [s, kind, text, other robot or ""]
    "choices": 60,  # [s, x m, y m, reason, {robot: bid}, unit of the bids]
    "log": 200,  # [s, level, node, text]
}


class Stream:
    """The newest `length` items. `first` is the number of the oldest of them."""

    def __init__(self, length: int) -> None:
        self.first = 0
        self._items: deque[Any] = deque(maxlen=length)

    @property
    def end(self) -> int:
        """Number of the next item."""
        return self.first + len(self._items)

    def append(self, item: Any) -> None:
        if len(self._items) == self._items.maxlen:
            self.first += 1
        self._items.append(item)

    def since(self, number: int) -> tuple[int, list[Any]]:
        """The items from that number on that are still there, and the number of the first of them."""
        begin = min(max(number, self.first), self.end)
        skipped = begin - self.first
        return begin, [item for index, item in enumerate(self._items) if index >= skipped]

    def extend(self, first: int, items: Sequence[Any]) -> None:
        """Items that begin with that number. What is known already is passed over; after a gap only the new ones
        are kept."""
        if first > self.end or first + len(items) < self.first:
            self._items.clear()
            self.first = first
        for item in items[max(0, self.end - first) :]:
            self.append(item)
