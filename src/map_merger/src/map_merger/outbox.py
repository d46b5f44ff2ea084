"""Effects of several threads, one after the other."""

import threading
from collections import deque
from typing import Callable, Deque, Iterable, List

from .effects import Effect, PublishMap, Register, Send
from .grid import Box

MOST_WAITING = 1000
"""Effects that wait. Beyond, the oldest of those that tell a state or a note is dropped; sends are refused when nothing
else waits."""
_OWED = (Send, Register, PublishMap)
"""Whoever wanted one waits for its end, or builds on it."""


class Outbox:
    """Carries out effects in the order in which they were put, whichever threads bring them.

    Without it a thread that is held up publishes its map after a newer one, and a latched topic keeps the older.
    It grows only while an effect is being carried out, by what the agent wants in that time. Of the map the newest
    waits, with all cells that changed meanwhile; there is one registration at a time. So these two are never dropped.
    """

    def __init__(self, carry_out: Callable[[Effect], None], most: int = MOST_WAITING) -> None:
        self._carry_out, self._most = carry_out, most
        self._effects: Deque[Effect] = deque()
        self._changing = threading.Lock()
        self._working = threading.Lock()

    def put(self, effects: Iterable[Effect]) -> List[Send]:
        """To be called in the order wanted, that is under the lock under which the agent gave them. Returns the sends
        for which there is no room: they are not carried out, and to be reported as not delivered."""
        refused: List[Send] = []
        with self._changing:
            for effect in effects:
                if isinstance(effect, PublishMap):
                    self._effects.append(self._joined(effect))
                elif len(self._effects) < self._most or isinstance(effect, Register) or self._drop_one():
                    self._effects.append(effect)
                elif isinstance(effect, Send):
                    refused.append(effect)
        return refused

    def work(self) -> None:
        """Carries out everything; while another thread does so, that one goes on and this one returns at once."""
        while self._effects and self._working.acquire(blocking=False):
            try:
                while self._effects:
                    with self._changing:
                        effect = self._effects.popleft()
                    self._carry_out(effect)
            finally:
                self._working.release()

    def _drop_one(self) -> bool:
        """False if everything that waits is owed."""
        for index, effect in enumerate(self._effects):
            if not isinstance(effect, _OWED):
                del self._effects[index]
                return True
        return False

    def _joined(self, new: PublishMap) -> PublishMap:
        """The map in place of one that waits."""
        for index, old in enumerate(self._effects):
            if isinstance(old, PublishMap):
                del self._effects[index]
                same = old.grid.info == new.grid.info
                changed = old.changed.union(new.changed) if same else Box(0, 0, *new.grid.info.shape)
                return PublishMap(new.grid, changed, new.boot)
        return new
