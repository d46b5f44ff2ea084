"""Orders that come by radio, and to whom this robot tells how it is: each mission control that was heard of lately."""

import math
from collections import OrderedDict
from dataclasses import replace
from typing import Callable, Dict, Mapping, Optional, Tuple

from explorer.answer import Answer
from explorer.messages import Emit, Note, SendState
from explorer.team_state import ORDERS, ROLL_CALL, SET_LIMITS, TeamOrder, TeamState

INTEREST = 30.0  # s for which a mission control is told after it was heard of
PERIOD = 5.0  # s between two tellings while nothing changes
LEAST_PERIOD = 0.5  # s between two of them if something does
MOST_CONTROLS = 8  # that are told
MOST_REMEMBERED = 100  # orders that are known to be carried out


class TeamOrders:
    """Bounded: the newest senders are told, the newest orders are remembered."""

    def __init__(
        self,
        carry_out: Mapping[str, Callable[[float], Answer]],
        set_limits: Callable[[float, float], Answer],
        emit: Emit,
    ) -> None:
        """`carry_out`: what to do at each order of `ORDERS`; `set_limits`: of time in s and distance in m."""
        self._carry_out, self._set_limits, self._emit = carry_out, set_limits, emit
        self._heard: Dict[str, float] = {}
        self._done: OrderedDict[Tuple[str, int], Answer] = OrderedDict()
        self._last: Optional[Tuple[str, int]] = None
        self._told: object = None
        self._told_at = -math.inf

    def take(self, order: TeamOrder, now: float) -> None:
        if order.sender not in self._heard:
            if len(self._heard) >= MOST_CONTROLS:
                del self._heard[min(self._heard, key=lambda name: self._heard[name])]
            self._told = None
        self._heard[order.sender] = now
        if order.order == ROLL_CALL:
            return
        self._told = None  # the sender waits for the answer, also if it has missed the first one
        key = (order.sender, order.number)
        if key not in self._done:
            self._done[key] = self._obey(order, now)
            while len(self._done) > MOST_REMEMBERED:
                self._done.popitem(last=False)
        self._last = key

    def _obey(self, order: TeamOrder, now: float) -> Answer:
        call = self._carry_out.get(order.order)
        if call is not None:
            answer = call(now)
        elif order.order == SET_LIMITS:
            answer = self._set_limits(*order.limits)
        else:
            return Answer(False, f"unknown order {order.order!r}; there are {', '.join((*ORDERS, SET_LIMITS))}")
        self._emit(Note(f"order of {order.sender}: {order.order}: {answer.text}"))
        return answer

    def due(self, what: object, now: float) -> bool:
        """It is time to tell those who want to know. `what`: of the state that is told at once when it changes."""
        self._heard = {name: heard for name, heard in self._heard.items() if abs(now - heard) <= INTEREST}
        what = (what, self._last)
        if not self._heard or abs(now - self._told_at) < (PERIOD if what == self._told else LEAST_PERIOD):
            return False
        self._told, self._told_at = what, now
        return True

    def tell(self, state: TeamState) -> None:
        """Adds to the state what came of the last order."""
        answer = self._done[self._last] if self._last is not None else state.answer
        for name in self._heard:
            self._emit(SendState(name, replace(state, order=self._last, answer=answer)))
