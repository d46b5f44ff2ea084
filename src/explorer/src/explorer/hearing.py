"""What the radio and the other robots tell, but for auctions: to the owners of what it changes."""

from typing import Sequence

from explorer.agreement import Agreement
from explorer.announcing import Announcing
from explorer.foreign import Element, ForeignFrontiers
from explorer.perception import Perception
from explorer.sharing import Sharing
from explorer.statement import Statement
from explorer.team import Team
from explorer.verdicts import Verdicts

MOVED_DISTANCE = 0.7  # m, a frontier this near to one that has vanished is the same, seen anew


class Hearing:
    """Takes what comes in; has no state of its own."""

    def __init__(
        self,
        team: Team,
        foreign: ForeignFrontiers,
        verdicts: Verdicts,
        agreement: Agreement,
        sharing: Sharing,
        announcing: Announcing,
        perception: Perception,
    ) -> None:
        self._team, self._foreign, self._verdicts, self._agreement = team, foreign, verdicts, agreement
        self._sharing, self._announcing, self._perception = sharing, announcing, perception

    def take_robots(self, names: Sequence[str]) -> None:
        """All robots that the radio reaches now."""
        came, left = self._team.set_known(names)
        if came:
            self._sharing.welcome(came)
            self._announcing.welcome()
        if left:
            self._agreement.forget(left)
            self._perception.touch()

    def take_explored(self, elements: Sequence[Element], now: float) -> None:
        """Points that another robot has explored: own points there are not goals until the map had time to show it.
        Where that robot still has points nearby the frontier has moved a little, and nothing is explored."""
        for element in elements:
            self._foreign.remove(element.key)
        places = []
        for element, moved in zip(elements, self._foreign.have_near(elements, MOVED_DISTANCE)):
            place = None if moved else self._foreign.to_own_frame(element)
            if place is not None:
                self._verdicts.believe_explored(element.detected_by, *place, now)
                places.append(place)
        self._perception.take_explored(places)

    def take_statement(self, statement: Statement, now: float) -> None:
        """What another robot has decided, and whether it has anything left."""
        if statement.robot in self._team.known() and self._agreement.take(statement, now):
            self._foreign.take_mission(statement.robot, statement.mission)

    def take_choice(self, elements: Sequence[Element], now: float) -> None:
        """The clusters that others have chosen (strategies 5 and 6)."""
        for robot in sorted({element.detected_by for element in elements}):
            self._team.heard(robot)
            self._team.claim(robot, [e.key for e in elements if e.detected_by == robot], now)
