"""How far one mission has come, and what of that outlives the node."""

from typing import Optional

from explorer.memory import Memory
from explorer.orders import ORDERED, STOPPED, Orders
from explorer.senses import Senses
from explorer.status import State


class Course:
    """`started_at`, `finished_at`: of the exploration, s, None while it has not come to that; `state`, `text`: what the
    robot does, the latter in words."""

    def __init__(self, orders: Orders) -> None:
        self._orders = orders
        self.state, self.text = State.STARTING, "waits for the map"
        self.started_at: Optional[float] = None
        self.finished_at: Optional[float] = None

    def be(self, state: State, text: str) -> None:
        self.state, self.text = state, text

    def wait_for(self, awaited: str) -> None:
        """The robot has not begun, for want of that; an order that it was given meanwhile is told."""
        order = self._orders.halt or self._orders.ended_by
        self.be(State.STARTING, f"{order}, waits for {awaited}" if order else f"waits for {awaited}")

    def exploration_time(self, now: float) -> float:
        """Seconds from the start of the mission, fixed once finished (T_r)."""
        if self.started_at is None:
            return 0.0
        return (self.finished_at if self.finished_at is not None else now) - self.started_at

    def skip(self, before: float, now: float) -> bool:
        """The clock was set forward in between: that is no time of an exploration that goes on. Whether one does."""
        if self.started_at is None or self.started_at > before or self.finished_at is not None:
            return False
        self.started_at += now - before
        return True

    def memory(self, senses: Senses) -> Memory:
        """What is to be kept of this mission."""
        orders = self._orders
        return Memory(
            senses.home, self.started_at, self.finished_at, orders.ended_by or "", orders.homeward, orders.halt,
            float(round(senses.distance)), senses.home_is_lost,
        )  # fmt: skip

    def recall(self, memory: Memory, senses: Senses, now: float) -> None:
        """Goes on with a mission of which only this was kept. Times that lie in the future are of another clock: such a
        mission starts anew, as when the clock is set back."""
        if memory.home is not None and senses.home is None:
            senses.home = memory.home
        senses.home_is_lost = senses.home_is_lost or memory.home_is_lost
        self._orders.halt = memory.halt
        ordered = memory.ended_by in ORDERED
        if memory.started_at is None and not ordered:
            return
        same_clock = memory.started_at is not None and memory.started_at <= now
        if memory.started_at is not None:
            self.started_at = memory.started_at if same_clock else now
        senses.distance = memory.distance if same_clock else 0.0
        if memory.ended_by and (same_clock or ordered):
            self._orders.ended_by, self._orders.homeward = memory.ended_by, memory.homeward
            self.finished_at = memory.finished_at if same_clock else now
        if memory.ended_by == STOPPED and not memory.homeward:
            self.be(State.FINISHED, STOPPED)
