"""What the robot knows, brought up to date: its own map, with what the others have said."""

from explorer.agreement import Agreement
from explorer.foreign import ForeignFrontiers
from explorer.perception import Perception
from explorer.sharing import Sharing
from explorer.team import Team
from explorer.verdicts import Verdicts


class Looking:
    """Perceives, and hands on what has vanished; has no state of its own."""

    def __init__(
        self,
        team: Team,
        foreign: ForeignFrontiers,
        verdicts: Verdicts,
        agreement: Agreement,
        sharing: Sharing,
        perception: Perception,
    ) -> None:
        self._team, self._foreign, self._verdicts, self._agreement = team, foreign, verdicts, agreement
        self._sharing, self._perception = sharing, perception

    def look(self, now: float) -> None:
        """There has to be a map and a pose."""
        heard = self._agreement.heard(now)
        if heard is not self._verdicts.heard:
            if heard.has_places or self._verdicts.heard.has_places:
                self._perception.touch()
            self._verdicts.heard = heard
        others, known = list(self._team.positions(now).values()), len(self._team.known())
        self._sharing.take_vanished(self._perception.update(self._verdicts, others, known, now))
        self._sharing.ask_transforms(self._foreign.robots(), now)
