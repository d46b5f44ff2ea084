"""What this robot says to its team of its verdicts and of the end, and when."""

import math
from typing import Optional, Tuple

from explorer.ending import Ending
from explorer.messages import Emit, SendStatement
from explorer.perception import Perception
from explorer.senses import Senses
from explorer.statement import MOST_LEFT, MOST_VERDICTS, LeftPlace, Stage, Statement
from explorer.team import Team
from explorer.verdicts import Verdicts

PERIOD = 2.0  # s between two statements, unless the stage is another
LEAST_PERIOD = 0.5  # s between two of them if it is
REFRESH_PERIOD = 10.0  # s after which the same is said again: a robot may have missed it


class Announcing:
    """Statements are whole: what is lost is in the next one."""

    def __init__(
        self,
        name: str,
        team: Team,
        senses: Senses,
        perception: Perception,
        verdicts: Verdicts,
        ending: Ending,
        emit: Emit,
    ) -> None:
        self._name, self._team, self._emit = name, team, emit
        self._senses, self._perception, self._verdicts, self._ending = senses, perception, verdicts, ending
        self._mission: Optional[int] = None
        self._number = 0
        self._said: Optional[Tuple[Stage, int]] = None
        self._said_at = -math.inf

    def welcome(self) -> None:
        """Robots came that have heard nothing yet."""
        self._said = None

    def say(self, stage: Stage, now: float) -> None:
        """Says it if that is due; there must be a map."""
        what = (stage, self._verdicts.revision + sum(self._ending.closer_looks.values()))
        if self._team.alone or not self._due(what, now):
            return
        if self._mission is None:
            self._mission = int(now * 1000.0) % 2**32  # another one after a restart
        self._number += 1
        self._emit(SendStatement(self._statement(stage, self._mission)))
        self._said, self._said_at = what, now

    def _due(self, what: Tuple[Stage, int], now: float) -> bool:
        if self._said is None:
            return True
        if what[0] != self._said[0]:
            return now - self._said_at >= LEAST_PERIOD
        return now - self._said_at >= (REFRESH_PERIOD if what == self._said else PERIOD)

    def _statement(self, stage: Stage, mission: int) -> Statement:
        occupancy = self._senses.map
        assert occupancy is not None
        verdicts = (*self._ending.looked(), *self._verdicts.decided(occupancy.info.resolution**2))
        left = self._perception.leftovers()[:MOST_LEFT] if stage != Stage.EXPLORING else ()
        return Statement(
            self._name,
            mission,
            self._number,
            stage,
            occupancy.known_area,
            verdicts[-MOST_VERDICTS:],
            tuple(LeftPlace(each.x, each.y, each.area, each.reason) for each in left),
        )
