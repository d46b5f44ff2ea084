"""What the own robot tells its group in short messages, and when: position, track, and transforms found."""

from typing import List, Optional

from .announcements import Announcements
from .believed import BelievedTransforms
from .driving import driving
from .effects import Effect, Purpose, Send
from .exchange import Exchange
from .messages import Position
from .observations import Observations
from .options import Options
from .own_transforms import OwnTransforms
from .payload import Payload
from .reference import Reference
from .report import positions_of
from .timer import Timer
from .topology import topology_of


class Announcer:
    """Owns what of it is due and under way."""

    def __init__(
        self,
        options: Options,
        exchange: Exchange,
        reference: Reference,
        observations: Observations,
        own_transforms: OwnTransforms,
        believed: BelievedTransforms,
    ) -> None:
        """Reads all of them anew each time."""
        self._options, self._topology = options, topology_of(options)
        self._exchange, self._reference, self._observations = exchange, reference, observations
        self._own_transforms, self._believed = own_transforms, believed
        self._announcements = Announcements(options.robot_name)
        self._position_timer = Timer(options.seconds_send_position)

    def due(self, now: float) -> List[Effect]:
        """What to send now, and everybody's positions for people."""
        effects = self._positions(now)
        if self._announcements.free(Purpose.TRACK):
            effects += self._told(Purpose.TRACK, self._track(now))
        if self._announcements.free(Purpose.EDGES):
            effects += self._told(Purpose.EDGES, self._own_transforms.report(now))
        return effects

    def ended(self, send: Send) -> bool:
        """The host finished a Send; True if it was one of these."""
        return self._announcements.ended(send)

    def _positions(self, now: float) -> List[Effect]:
        if not (self._options.exchange_position and self._position_timer.fires(now)):
            return []
        whereabouts, effects = self._observations.whereabouts, []
        if whereabouts.own_pose is not None and self._options.has_local_map:
            effects += self._told(Purpose.POSITION, Position(self._options.robot_name, whereabouts.own_pose))
        return effects + positions_of(self._options, whereabouts, self._believed.transforms(), now)

    def _track(self, now: float) -> Optional[Payload]:
        meetings = self._observations.meetings
        heard = driving(self._topology, self._exchange, self._observations.whereabouts)
        meetings.on_team(heard, self._believed.transforms(), self._reference.robot)
        return meetings.report(now)

    def _told(self, purpose: Purpose, payload: Optional[Payload]) -> List[Effect]:
        send = None if payload is None else self._announcements.send(purpose, payload)
        return [] if send is None else [send]
