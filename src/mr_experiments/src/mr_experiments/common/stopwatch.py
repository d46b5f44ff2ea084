"""Processor time by component."""

from __future__ import annotations

import time
from collections import defaultdict
from typing import ContextManager


class Stopwatch:
    """Adds up time under names; what runs inside another span counts for the inner one alone.

    Spans are told apart by wall time and scaled to processor time in the end: asking the system for processor time at
    every border would take longer than some components do.
    """

    def __init__(self) -> None:
        self.spent: dict[str, float] = defaultdict(float)  # s of wall time
        self.running: list[str] = []  # the innermost last
        self.since = self._begun = time.perf_counter()
        self._begun_cpu = time.process_time()
        self._spans: dict[str, _Span] = {}

    def span(self, component: str) -> ContextManager[None]:
        span = self._spans.get(component)
        if span is None:
            span = self._spans[component] = _Span(self, component)
        return span

    def seconds(self) -> dict[str, float]:
        """s of processor time that each component has used so far."""
        wall, cpu = time.perf_counter() - self._begun, time.process_time() - self._begun_cpu
        scale = cpu / wall if wall > 0.0 else 1.0
        return {component: spent * scale for component, spent in sorted(self.spent.items())}


class _Span:
    """Kept and entered again, without further calls: a mission enters tens of thousands."""

    def __init__(self, stopwatch: Stopwatch, component: str) -> None:
        self._stopwatch, self._component = stopwatch, component

    def __enter__(self) -> None:
        watch, now = self._stopwatch, time.perf_counter()
        if watch.running:
            watch.spent[watch.running[-1]] += now - watch.since
        watch.running.append(self._component)
        watch.since = now

    def __exit__(self, *_: object) -> None:
        watch, now = self._stopwatch, time.perf_counter()
        watch.spent[watch.running.pop()] += now - watch.since
        watch.since = now
