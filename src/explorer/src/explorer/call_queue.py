"""The order of calls that block, several of which may be under way at once."""

import collections
import math
from typing import Callable, Deque, Optional, Tuple

HANDOVER = 0.1  # s in which a message is with adhoc_communication, which keeps the order from there on
CALLS = 100  # calls of adhoc_communication that may wait

Call = Callable[[], None]


class CallQueue:
    """Calls start in the order given: each when the one before has ended, or has been under way for `handover` seconds,
    after which whoever is called surely has it.

    That is enough to keep messages in order: adhoc_communication delivers those of one sender and group in the order
    in which it took them. Waiting for the end of each would hold up all others while one robot is hard to reach.
    Bounded: when `size` calls wait, the oldest is lost. No clock, no lock: the caller has them.
    """

    def __init__(self, size: int, handover: float = math.inf) -> None:
        self._size = size
        self._handover = handover
        self._waiting: Deque[Call] = collections.deque()
        self._latest = 0
        self._latest_ended = True
        self._latest_start = -math.inf

    def put(self, call: Call) -> bool:
        """False if the oldest call was lost for it."""
        full = len(self._waiting) >= self._size
        if full:
            self._waiting.popleft()
        self._waiting.append(call)
        return not full

    def take(self, now: float) -> Optional[Tuple[int, Call]]:
        """The call to start now, with its number for `ended`, or None."""
        if self.pause(now) != 0.0:
            return None
        self._latest += 1
        self._latest_ended, self._latest_start = False, now
        return self._latest, self._waiting.popleft()

    def pause(self, now: float) -> Optional[float]:
        """Seconds until a call may start; None: not before another `put` or `ended`."""
        if not self._waiting:
            return None
        if self._latest_ended:
            return 0.0
        left = max(0.0, self._latest_start + self._handover - now)
        return left if math.isfinite(left) else None

    def ended(self, number: int) -> None:
        if number == self._latest:
            self._latest_ended = True
