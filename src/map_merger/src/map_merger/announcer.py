"""What the own robot tells its group in short messages, and when: position, track, and transforms found."""

import math
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
from .report import positions_of, tracks_of
from .timer import Timer
from .topology import topology_of

NEAR_M = 3.0  # to another robot, from which both must know where the other is now,
NEAR_PERIOD_S = 0.4  # and tell their positions as often
NEAR_AGE_S = 6.0  # of a position that says so


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
        self._near_timer = Timer(NEAR_PERIOD_S)

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

    def positions(self, now: float) -> List[Effect]:
        """Everybody's positions as they are known."""
        return [positions_of(self._options, self._observations.whereabouts, self._believed.transforms(), now)]

    def _positions(self, now: float) -> List[Effect]:
        if not self._options.exchange_position:
            return []
        effects: List[Effect] = []
        regular = self._position_timer.fires(now)
        if self._near_timer.fires(now) if self._is_near_another(now) else regular:
            effects += self._told(Purpose.POSITION, self._own_position())
        if regular:
            effects += self.positions(now)
            effects += tracks_of(self._options, self._observations.whereabouts, self._believed.transforms())
        return effects

    def _own_position(self) -> Optional[Position]:
        pose = self._observations.whereabouts.own_pose if self._options.has_local_map else None
        return None if pose is None else Position(self._options.robot_name, pose)

    def _is_near_another(self, now: float) -> bool:
        whereabouts = self._observations.whereabouts
        own = whereabouts.own_pose
        if own is None:
            return False
        places = whereabouts.places(self._believed.transforms(), now, NEAR_AGE_S)
        return any(math.hypot(place.x - own.x, place.y - own.y) < NEAR_M for place in places)

    def _track(self, now: float) -> Optional[Payload]:
        meetings = self._observations.meetings
        heard = driving(self._topology, self._exchange, self._observations.whereabouts)
        meetings.on_team(heard, self._believed.transforms(), self._reference.robot)
        return meetings.report(now)

    def _told(self, purpose: Purpose, payload: Optional[Payload]) -> List[Effect]:
        send = None if payload is None else self._announcements.send(purpose, payload)
        return [] if send is None else [send]
