"""What a robot says to its team of its verdicts and of the end, as plain values."""

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple, Tuple

MOST_VERDICTS = 200  # of one statement, the newest
MOST_LEFT = 50  # places of one statement, the largest


class Kind(IntEnum):
    """Values of `explorer/TeamVerdict`."""

    VISITED = 1
    GIVEN_UP = 2
    LOOKED = 3


class Stage(IntEnum):
    """Values of `explorer/TeamVerdicts`."""

    EXPLORING = 0
    NOTHING_LEFT = 1
    ENDED = 2
    QUIT = 3


class Decided(NamedTuple):
    """A verdict on the frontier point at (x, y), metres in the frame of the robot that has decided. `known`: m^2 that
    it knew within a metre of the point when it did."""

    x: float
    y: float
    kind: Kind
    known: float


class LeftPlace(NamedTuple):
    """Frontier points near (x, y), metres in the frame of the robot that leaves them, with `area` m^2 of unknown behind
    them at most."""

    x: float
    y: float
    area: float
    reason: str


@dataclass(frozen=True)
class Statement:
    """All that `robot` has decided so far in its `mission`; `number` grows with each statement. `area`: known, m^2.
    `left`: what it leaves; told from the stage NOTHING_LEFT on."""

    robot: str
    mission: int
    number: int
    stage: Stage
    area: float
    verdicts: Tuple[Decided, ...] = ()
    left: Tuple[LeftPlace, ...] = ()
