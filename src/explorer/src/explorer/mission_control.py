"""A mission control: knows how each robot of the team is, and gets orders to them, also when they are out of reach.

Pure as the agent is: every call takes `now` in seconds, `tick` returns what is to be sent."""

from dataclasses import dataclass, field
from typing import Dict, List, NamedTuple, Optional, Sequence

from explorer.answer import Answer
from explorer.limits import NO_LIMITS, Limits
from explorer.status import State
from explorer.team_state import ORDERS, ROLL_CALL, SET_LIMITS, TeamOrder, TeamState

ROLL_CALL_PERIOD = 5.0  # s
REPEAT_PERIOD = 2.0  # s after which an order that was not answered is sent again
RADIO_SILENT = 5.0  # s without a word of adhoc_communication, after which nobody is in reach
MOST_ROBOTS = 100  # further ones are not watched
NEVER = -1.0  # age of a state that was not told


class SendOrder(NamedTuple):
    """To one robot."""

    robot: str
    order: TeamOrder


def _kind(order: TeamOrder) -> str:
    """An order takes the place of an earlier one of its kind: limits hold whatever the course is."""
    return "limits" if order.order == SET_LIMITS else "course"


@dataclass
class _Given:
    """An order for one robot, and when it was sent."""

    order: TeamOrder
    answered: bool = False
    sent: float = float("-inf")

    def is_due(self, now: float) -> bool:
        return not self.answered and abs(now - self.sent) >= REPEAT_PERIOD


@dataclass
class _Watched:
    """`given`: the last order of each kind, the newest last."""

    in_reach: bool = False
    state: Optional[TeamState] = None
    told: float = 0.0
    given: Dict[str, _Given] = field(default_factory=dict)
    called: float = float("-inf")

    def give(self, order: TeamOrder) -> None:
        self.given.pop(_kind(order), None)
        self.given[_kind(order)] = _Given(order)

    @property
    def shown(self) -> Optional[_Given]:
        """The newest order that was not answered, or the newest."""
        newest_first = list(reversed(list(self.given.values())))
        return next((given for given in newest_first if not given.answered), next(iter(newest_first), None))


@dataclass(frozen=True)
class Member:
    """One robot: what it has told last, `age` s ago (`NEVER`), and the last order from here."""

    robot: str
    in_reach: bool
    state: Optional[TeamState]
    age: float
    order: str
    answered: bool


class MissionControl:
    """Owner of what is known of the team. A robot that is ordered something while it is out of reach gets it when it is
    back, and so does one that was never heard of, if all were ordered; of several orders only the last, and of several
    limits."""

    def __init__(self, name: str, first_number: int) -> None:
        """`name` of this robot or base station; `first_number`: of its orders, another one after each start."""
        self._name, self._number = name, first_number
        self._robots: Dict[str, _Watched] = {}
        self._for_all: Dict[str, TeamOrder] = {}
        self._heard_radio: Optional[float] = None  # s
        self._radio_silent = True

    def order(self, order: str, robots: Sequence[str] = (), limits: Limits = NO_LIMITS) -> Answer:
        """Takes an order to these robots, or to all. Whether they take the `limits` of `SET_LIMITS` the robots say."""
        if order not in (*ORDERS, SET_LIMITS):
            return Answer(False, f"unknown order {order!r}; there are {', '.join((*ORDERS, SET_LIMITS))}")
        strange = [robot for robot in robots if robot not in self._robots]
        if strange:
            known = ", ".join(sorted(self._robots)) or "none yet"
            return Answer(False, f"no robot {', '.join(strange)} was heard of; there are {known}")
        self._number += 1
        new = TeamOrder(self._name, self._number, order, limits)
        if not robots:
            self._for_all[_kind(new)] = new
        for robot in robots or self._robots:
            self._robots[robot].give(new)
        return self._answer(order, sorted(robots or self._robots))

    def _answer(self, order: str, robots: Sequence[str]) -> Answer:
        there = [robot for robot in robots if self._robots[robot].in_reach]
        away = [robot for robot in robots if robot not in there]
        parts = [f"{order}: sent to {', '.join(there)}"] if there else [f"{order}: no robot is in reach"]
        if self._radio_silent:
            parts.append("adhoc_communication says nothing, is it running?")
        if away:
            parts.append(f"{', '.join(away)} get it when they are back")
        return Answer(bool(there), "; ".join(parts))

    def on_robots(self, names: Sequence[str], now: float) -> None:
        """All robots that the radio reaches now, told about once a second."""
        self._heard_radio, self._radio_silent = now, False
        for name in names:
            if name not in self._robots and len(self._robots) < MOST_ROBOTS:
                self._robots[name] = _Watched()
                for order in self._for_all.values():
                    self._robots[name].give(order)
        for name, watched in self._robots.items():
            watched.in_reach = name in names

    def on_state(self, state: TeamState, now: float) -> None:
        """A robot tells how it is. What is told by robots that the radio does not know is not believed."""
        watched = self._robots.get(state.robot)
        if watched is None:
            return
        watched.state, watched.told = state, now
        for given in watched.given.values():
            given.answered |= state.order == (given.order.sender, given.order.number)

    def tick(self, now: float) -> List[SendOrder]:
        """What is to be sent now; call it about twice a second."""
        sent = []
        self._radio_silent = self._heard_radio is None or abs(now - self._heard_radio) > RADIO_SILENT
        for name, watched in self._robots.items():
            watched.in_reach = watched.in_reach and not self._radio_silent
            if not watched.in_reach:
                watched.called = float("-inf")
                continue
            due = next((given for given in watched.given.values() if given.is_due(now)), None)
            if due is not None:
                due.sent = watched.called = now
                sent.append(SendOrder(name, due.order))
            elif abs(now - watched.called) >= ROLL_CALL_PERIOD:
                watched.called = now
                sent.append(SendOrder(name, TeamOrder(self._name, 0, ROLL_CALL)))
        return sent

    def members(self, now: float) -> List[Member]:
        """All robots heard of, by name."""
        return [
            Member(
                name,
                watched.in_reach,
                watched.state,
                NEVER if watched.state is None else max(0.0, now - watched.told),
                "" if watched.shown is None else watched.shown.order.order,
                watched.shown is None or watched.shown.answered,
            )
            for name, watched in sorted(self._robots.items())
        ]


def summary_of(members: Sequence[Member]) -> str:
    """One line for people."""
    if not members:
        return "no robot was heard of"
    return "; ".join(f"{member.robot}: {_words(member)}" for member in members)


def _words(member: Member) -> str:
    if member.state is None:
        said = "has told nothing"
    else:
        known = member.state.state in set(State)
        stage = State(member.state.state).name.lower() if known else "unknown"
        said = member.state.text if member.state.text.startswith(stage) else f"{stage}, {member.state.text}"
    waits = "" if member.answered else f", has not answered to {member.order}"
    away = "" if member.in_reach else f", out of reach for {member.age:.0f} s" if member.age >= 0 else ", out of reach"
    return f"{said}{waits}{away}"
