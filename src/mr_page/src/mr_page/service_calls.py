"""Calls of services that may hang. rospy has no limit of time for them. Knows no ROS."""

from __future__ import annotations

import threading
from typing import Callable

from mr_page.commands import Answer

PATIENCE = 5.0  # s


class ServiceCalls:
    """Each runs in a thread of its own, which is left behind when the service does not answer. Until it does, that
    service is not called again: one thread each at most."""

    def __init__(self, patience: float = PATIENCE) -> None:
        self._patience = patience
        self._lock = threading.Lock()
        self._running: set[str] = set()

    def answer(self, service: str, call: Callable[[], Answer]) -> Answer:
        """Of `call`, which does not raise; blocks for the time of patience at most."""
        with self._lock:
            if service in self._running:
                return Answer(False, f"the service {service} has not answered an earlier call yet")
            self._running.add(service)
        answers: list[Answer] = []
        thread = threading.Thread(target=self._run, args=(service, call, answers), daemon=True)
        thread.start()
        thread.join(self._patience)
        late = Answer(False, f"the service {service} does not answer within {self._patience:g} s; see whether it hangs")
        return answers[0] if answers else late

    def _run(self, service: str, call: Callable[[], Answer], answers: list[Answer]) -> None:
        try:
            answers.append(call())
        finally:
            with self._lock:
                self._running.discard(service)
