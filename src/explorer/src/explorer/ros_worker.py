"""Threads for calls that block."""

import threading
import time
from typing import Callable, Tuple

import rospy

from explorer.call_queue import CallQueue
from mr_grid.ros import CALL_FAILED, reason_of
from mr_grid.ros_node import begin_thread


class Worker:
    """Makes calls in the order of a `CallQueue`; they end with the node."""

    def __init__(self, name: str, threads: int, calls: CallQueue) -> None:
        """`name`: of what is called, for messages."""
        self._name = name
        self._calls = calls
        self._ready = threading.Condition()
        for _ in range(threads):
            begin_thread(f"calls of {name}", self._run)

    def do(self, call: Callable[[], None]) -> None:
        """Soon. What `CALL_FAILED` names may come of it, and is reported once in a while."""
        with self._ready:
            if not self._calls.put(call):
                rospy.logwarn_throttle(30.0, f"explorer: {self._name} is too slow, the oldest call is dropped")
            self._ready.notify_all()

    def _run(self) -> None:
        while not rospy.is_shutdown():
            number, call = self._take()
            try:
                call()
            except CALL_FAILED as error:
                rospy.logwarn_throttle(30.0, f"explorer: {self._name}: {reason_of(error)}")
            finally:
                with self._ready:
                    self._calls.ended(number)
                    self._ready.notify_all()

    def _take(self) -> Tuple[int, Callable[[], None]]:
        with self._ready:
            while True:
                taken = self._calls.take(time.monotonic())
                if taken is not None:
                    return taken
                self._ready.wait(self._calls.pause(time.monotonic()))
