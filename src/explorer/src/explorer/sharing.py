"""What the team is told of the own frontiers, and which transforms are asked for."""

import math
from typing import Dict, Iterable, List, Sequence, Set, Tuple

from explorer.foreign import Element
from explorer.frontiers import Frontier, FrontierStore
from explorer.messages import AskTransform, Emit, SendFrontiers
from explorer.team import Team
from explorer.verdicts import Verdicts

SHARE_PERIOD = 1.5  # s between two messages with frontiers
REFRESH_PERIOD = 30.0  # s after which all own frontiers are sent again
TRANSFORM_PERIOD = 5.0  # s after which a transform is asked for again


class Sharing:
    """Sends what the others do not have yet: new points, and points that are explored."""

    def __init__(self, name: str, team: Team, frontiers: FrontierStore, verdicts: Verdicts, emit: Emit) -> None:
        self._name, self._team = name, team
        self._frontiers, self._verdicts = frontiers, verdicts
        self._emit = emit
        self._sent: Set[int] = set()
        self._vanished: Dict[int, Frontier] = {}
        self._share_time = -math.inf
        self._refresh_time = -math.inf
        self._transform_times: Dict[str, float] = {}

    def sent(self) -> List[Frontier]:
        """The points that the others know and that are still there."""
        return [frontier for frontier in self._frontiers.ordered() if frontier.number in self._sent]

    def take_vanished(self, gone: Iterable[Frontier]) -> None:
        """These points are no frontiers any more."""
        self._vanished.update({frontier.number: frontier for frontier in gone if frontier.number in self._sent})

    def recall(self, frontiers: Iterable[Frontier]) -> None:
        """Takes back points that were sent in a former mission."""
        self._vanished.update({frontier.number: frontier for frontier in frontiers})

    def welcome(self, robots: Sequence[str]) -> None:
        """Robots that came get everything, and are asked anew."""
        self._refresh_time = -math.inf
        for robot in robots:
            self._transform_times.pop(robot, None)

    def share(self, now: float, force: bool = False) -> None:
        """Sends what is new if that is due, or at once by `force`."""
        if self._team.alone or (now - self._share_time < SHARE_PERIOD and not force):
            return
        if now - self._refresh_time >= REFRESH_PERIOD:
            self._sent = set()
            self._refresh_time = now
        new = self._new_ones()
        if new:
            self._emit(SendFrontiers("frontiers", elements(self._name, new)))
            self._sent.update(frontier.number for frontier in new)
        if self._vanished:
            gone = [self._vanished[number] for number in sorted(self._vanished)]
            self._emit(SendFrontiers("visited_frontiers", elements(self._name, gone)))
            self._sent.difference_update(self._vanished)
            self._vanished = {}
        if new or force:
            self._share_time = now

    def _new_ones(self) -> List[Frontier]:
        unsent = [frontier for frontier in self._frontiers.ordered() if frontier.number not in self._sent]
        return [frontier for frontier in unsent if not self._verdicts.of(frontier.number).visited]

    def ask_transforms(self, robots: Sequence[str], now: float) -> None:
        """Asks for the transforms of these robots, each now and then."""
        for robot in robots:
            if now - self._transform_times.get(robot, -math.inf) >= TRANSFORM_PERIOD:
                self._transform_times[robot] = now
                self._emit(AskTransform(robot))


def elements(name: str, frontiers: Iterable[Frontier]) -> Tuple[Element, ...]:
    """Own frontiers as they travel."""
    return tuple(Element(name, frontier.number, frontier.x, frontier.y) for frontier in frontiers)
