"""Processor time by component."""

from __future__ import annotations

import time
from collections import defaultdict
from typing import ContextManager


class Stopwatch:
    """Adds up processor time in s under names; what runs inside another span counts for the inner one alone."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = defaultdict(float)
        self._running: list[str] = []
        self._since = time.process_time()
        self._spans: dict[str, _Span] = {}

    def span(self, component: str) -> ContextManager[None]:
        if component not in self._spans:
            self._spans[component] = _Span(self, component)
        return self._spans[component]

    def enter(self, component: str) -> None:
        self._switch()
        self._running.append(component)

    def leave(self) -> None:
        self._switch()
        self._running.pop()

    def _switch(self) -> None:
        now = time.process_time()
        if self._running:
            self.seconds[self._running[-1]] += now - self._since
        self._since = now


class _Span:
    """Kept and entered again: a mission enters hundreds of thousands."""

    def __init__(self, stopwatch: Stopwatch, component: str) -> None:
        self._stopwatch, self._component = stopwatch, component

    def __enter__(self) -> None:
        self._stopwatch.enter(self._component)

    def __exit__(self, *_: object) -> None:
        self._stopwatch.leave()
