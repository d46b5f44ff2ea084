"""What the other robots have said: who has anything left to explore, and what they have decided."""

from typing import Dict, Iterable, List, Optional, Sequence, Tuple, Union

import numpy as np

from explorer.foreign import Element, ForeignFrontiers
from explorer.geometry import Position
from explorer.heard import Heard, HeardVerdict, Witness
from explorer.statement import Decided, LeftPlace, Stage, Statement
from explorer.team import MAXIMUM_ROBOTS

DONE = (Stage.NOTHING_LEFT, Stage.ENDED)
SILENT_AFTER = 25.0  # s without a statement, two and a half refreshes, after which a robot does not count as exploring


class Agreement:
    """The last statement of each robot in reach, whole, so that none that is lost or doubled does harm. It only ever
    makes less of what is left, and with a robot goes its word."""

    def __init__(self, foreign: ForeignFrontiers) -> None:
        self._foreign = foreign
        self._said: Dict[str, Statement] = {}
        self._said_at: Dict[str, float] = {}
        self._seen: Tuple[int, int, Tuple[str, ...]] = (-1, -1, ())
        self._revision = 0
        self._heard = Heard()

    def take(self, statement: Statement, now: float) -> bool:
        """False if it is older than what that robot has said already."""
        last = self._said.get(statement.robot)
        if last is not None and last.mission == statement.mission and statement.number <= last.number:
            return False
        if last is None and len(self._said) >= MAXIMUM_ROBOTS:
            return False
        self._said[statement.robot], self._said_at[statement.robot] = statement, now
        self._revision += 1
        return True

    def forget(self, robots: Iterable[str]) -> None:
        """These robots have left."""
        for robot in robots:
            self._said_at.pop(robot, None)
            if self._said.pop(robot, None) is not None:
                self._revision += 1

    def stage(self, robot: str) -> Optional[Stage]:
        """None for a robot that says nothing of it."""
        statement = self._said.get(robot)
        return None if statement is None else statement.stage

    def heard(self, now: float) -> Heard:
        """By the newest transforms; robots without one say nothing of places. The same object while nothing changes."""
        explorers = tuple(robot for robot in sorted(self._said) if self._explores(robot, now))
        seen = (self._revision, self._foreign.transform_revision, explorers)
        if seen != self._seen:
            self._seen, self._heard = seen, self._placed(explorers)
        return self._heard

    def _explores(self, robot: str, now: float) -> bool:
        return self._said[robot].stage == Stage.EXPLORING and now - self._said_at[robot] < SILENT_AFTER

    def _placed(self, explorers: Tuple[str, ...]) -> Heard:
        verdicts: List[HeardVerdict] = []
        witnesses: List[Witness] = []
        for robot, said in sorted(self._said.items()):
            if not self._foreign.has_transform(robot):
                continue
            for each in said.verdicts:
                verdicts += [HeardVerdict(*p, each.kind, each.known, robot) for p in self._places(robot, [each])]
            if said.stage in DONE:
                places_left = np.array(self._places(robot, said.left), dtype=float).reshape(-1, 2)
                witnesses.append(Witness(robot, said.area, places_left, said.stage == Stage.ENDED))
        return Heard(tuple(verdicts), tuple(witnesses), tuple(sorted(self._said)), explorers)

    def _places(self, robot: str, told: Sequence[Union[Decided, LeftPlace]]) -> List[Position]:
        """Where that is in metres in the own frame."""
        moved = [self._foreign.to_own_frame(Element(robot, 0, each.x, each.y)) for each in told]
        return [place for place in moved if place is not None]
