"""Effects of several threads, one after the other."""

import threading
from collections import deque
from typing import Callable, Deque, Iterable

from .effects import Effect


class Outbox:
    """Carries out effects in the order in which they were put, whichever threads bring them.

    Without it a thread that is held up publishes its map after a newer one, and a latched topic keeps the older.
    It grows only while an effect is being carried out, by what the agent wants in that time.
    """

    def __init__(self, carry_out: Callable[[Effect], None]) -> None:
        self._carry_out = carry_out
        self._effects: Deque[Effect] = deque()
        self._working = threading.Lock()

    def put(self, effects: Iterable[Effect]) -> None:
        """To be called in the order wanted, that is under the lock under which the agent gave them."""
        self._effects.extend(effects)

    def work(self) -> None:
        """Carries out everything; while another thread does so, that one goes on and this one returns at once."""
        while self._effects and self._working.acquire(blocking=False):
            try:
                while self._effects:
                    self._carry_out(self._effects.popleft())
            finally:
                self._working.release()
