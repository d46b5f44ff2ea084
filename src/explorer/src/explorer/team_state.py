"""What mission controls and robots tell one another, as plain values."""

from dataclasses import dataclass
from typing import Optional, Tuple

from explorer.answer import NO_ANSWER, Answer
from explorer.limits import NO_LIMITS, Limits

ORDERS = ("start", "pause", "resume", "return_now", "stop", "go_home")
SET_LIMITS = "set_limits"
ROLL_CALL = ""  # an order that only asks for the state


@dataclass(frozen=True)
class TeamOrder:
    """From the mission control on `sender`. `number`: of this order among those of the sender; `order` of `ORDERS`,
    `SET_LIMITS` with `limits`, or `ROLL_CALL`."""

    sender: str
    number: int
    order: str
    limits: Limits = NO_LIMITS


@dataclass(frozen=True)
class TeamState:
    """How a robot is. `state`, `text` as in `Status`; `merging`: the same of map_merger in words; `area` known in m^2;
    `order`: the one that it has dealt with last, `answer` what came of it; None before the first."""

    robot: str
    state: int
    text: str
    merging: str = ""
    ended_by: str = ""
    exploration_time: float = 0.0
    area: float = 0.0
    order: Optional[Tuple[str, int]] = None
    answer: Answer = NO_ANSWER
