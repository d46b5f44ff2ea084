"""The rounds of a node's loop, for those who wait until what was there before is worked up."""

import contextlib
import threading
from typing import Callable, Iterator


class Rounds:
    """Counts them. One thread makes rounds, any may wait."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._begun = self._ended = 0

    @contextlib.contextmanager
    def next_one(self) -> Iterator[None]:
        """Around what the loop does in a round."""
        with self._changed:
            self._begun += 1
        try:
            yield
        finally:
            with self._changed:
                self._ended = self._begun
                self._changed.notify_all()

    def wait_for_whole_one(self, hurry: Callable[[], None]) -> None:
        """Until one has ended that began after this call. `hurry`: lets the loop begin it now."""
        with self._changed:
            awaited = self._begun + 1
            hurry()
            self._changed.wait_for(lambda: self._ended >= awaited)
