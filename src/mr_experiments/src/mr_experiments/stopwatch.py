"""Processor time by component."""

from __future__ import annotations

import time
from collections import defaultdict
from typing import ContextManager


class Stopwatch:
    """Adds up processor time in s under names; what runs inside another span counts for the inner one alone."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = defaultdict(float)
        self.running: list[str] = []  # the innermost last
        self.since = time.process_time()
        self._spans: dict[str, _Span] = {}

    def span(self, component: str) -> ContextManager[None]:
        span = self._spans.get(component)
        if span is None:
            span = self._spans[component] = _Span(self, component)
        return span


class _Span:
    """Kept and entered again, without further calls: a mission enters tens of thousands."""

    def __init__(self, stopwatch: Stopwatch, component: str) -> None:
        self._stopwatch, self._component = stopwatch, component

    def __enter__(self) -> None:
        watch, now = self._stopwatch, time.process_time()
        if watch.running:
            watch.seconds[watch.running[-1]] += now - watch.since
        watch.running.append(self._component)
        watch.since = now

    def __exit__(self, *_: object) -> None:
        watch, now = self._stopwatch, time.process_time()
        watch.seconds[watch.running.pop()] += now - watch.since
        watch.since = now
