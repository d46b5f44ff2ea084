"""What the own robot tells of its map: the anchor, changes, and again what was not delivered."""

import math
from typing import List, Optional, Sequence, Set

from mr_grid import GridError, OccupancyGrid, empty_grid

from ..effects import Effect, Note, Outcome, Purpose, SaveDebugImages, Send
from ..messages import Anchor, Boot, Tile
from ..options import Options
from ..payload import Payload
from ..timer import Timer
from ..topology import topology_of
from . import bounds
from .holding import Holding
from .retry import Retry
from .sender import MapSender


class Broadcast:
    """At most one send of changes and one of the anchor are under way; the next waits for its end."""

    def __init__(self, options: Options, boot: Boot) -> None:
        self._name = options.robot_name
        self._tile_size = options.split_size if options.splitted else None
        topology = topology_of(options)
        self._destination = topology.map_destination
        # What a base tells was held back by the robots before.
        self._holds = not topology.is_base
        self._debug = options.debug
        self._effects: List[Effect] = []
        self._sends = 0
        self._outstanding: Set[Purpose] = set()
        self.begin_run(boot)
        self._said: Set[str] = set()
        self._retry = Retry(bounds.FIRST_PAUSE_S, bounds.LONGEST_RESEND_PAUSE_S)
        self._changes_timer = Timer(options.seconds_send_timer)
        self._repair_timer = Timer(bounds.REPAIR_PERIOD_S)
        self._anchor_timer = Timer(options.seconds_meta_timer, options.seconds_meta_timer)

    def begin_run(self, boot: Boot) -> None:
        """The map to tell begins anew, in another frame."""
        self.sender = MapSender(self._name, self._tile_size, boot)
        self._local: Optional[OccupancyGrid] = None
        self._sent_before: Optional[OccupancyGrid] = None
        self._undelivered: Set[int] = set()
        self._holding = Holding()
        self._announced = False
        self._announced_at = -math.inf
        self._news_at = -math.inf
        self._at_once = False
        self._all = False

    def tell_at_once(self) -> None:
        """What changed does not wait for the timer."""
        self._at_once = True

    def on_map(self, grid: OccupancyGrid, told: bool = True) -> bool:
        """The own map changed. False, and a warning, if it cannot be that of this run. told: False if the others are
        told another one on the same lattice."""
        try:
            self.sender.check(grid)
            if told:
                self.sender.set_map(grid)
        except GridError as error:
            self._warn_once("ignoring", f"local map ignored: {error}; restart map_merger to begin anew with it")
            return False
        self._local = grid if told else self._local
        return True

    def on_sent(self, send: Send, outcome: Outcome, now: float) -> None:
        """A send of this object ended."""
        self._outstanding.discard(send.purpose)
        if send.purpose is not Purpose.CHANGES or self._of_former_run(send):
            return
        missed = set(_numbers(outcome.undelivered))
        self._undelivered.difference_update(_numbers(send.payloads))
        self._undelivered.update(missed)
        self._undelivered.difference_update(sorted(self._undelivered)[: -bounds.MOST_RESENT])
        self._announced = self._announced or not any(isinstance(payload, Anchor) for payload in outcome.undelivered)
        if len(missed) < len(set(_numbers(send.payloads))) or not outcome.undelivered:
            self._retry.progress(now)
        if outcome.too_large is not None:
            self.halve(outcome.too_large)

    def halve(self, refused: Tile) -> None:
        """The tile was too large to be sent."""
        rows, columns = refused.cells.shape
        size = f"a piece of the map of {rows} x {columns} cells is larger than adhoc_communication sends"
        if self.sender.halve(refused):
            self._retry.at_once()
            self._warn_once("halving", f"{size}: pieces are halved until they fit; see max_packet_size")
        else:
            self._warn_once("refused", f"{size}, and is not cut further: raise max_packet_size")

    def tick(self, now: float, heard: bool) -> None:
        """Sends what is due. `heard`: there are other robots."""
        due = self._changes_timer.fires(now) or self._at_once or self._all
        resend = self._repair_timer.fires(now) and bool(self._undelivered)
        if (due or resend) and Purpose.CHANGES not in self._outstanding:
            self._at_once = False
            self._send_changes(now, due)
        if self._anchor_timer.fires(now) and heard and not self._resting(now):
            self._send_anchor(now)

    def repeat_at_once(self) -> None:
        """A robot is back: what was not delivered is sent again without a pause, and nothing is held back."""
        self._retry.at_once()
        self._all = True

    def effects(self) -> List[Effect]:
        """Sends and notes since the last call."""
        effects, self._effects = self._effects, []
        return effects

    def _send_changes(self, now: float, news: bool) -> None:
        tiles = self._news(now) if news else []
        if self._undelivered and self._retry.ready(now):
            tiles += self.sender.repeated(self._undelivered)
        anchor = self.sender.anchor()
        if tiles and anchor is not None:
            self._announced_at = self._announced_at if self._announced else now
            self._send(Purpose.CHANGES, [*([] if self._announced else [anchor]), *tiles])

    def _news(self, now: float) -> List[Tile]:
        everything, self._all = self._all or not self._holds, False
        try:
            tiles = self.sender.changes(lambda changed, known: everything or self._holding.worth(changed, known, now))
        except GridError as error:
            self._warn_once("sending", f"local map not sent: {error}")
            return []
        self._news_at = now if tiles else self._news_at
        if tiles and self._debug and self._local is not None:
            self._effects.append(SaveDebugImages(self._local, self._sent_before or empty_grid(self._local.info)))
            self._sent_before = self._local
        return tiles

    def _send_anchor(self, now: float) -> None:
        anchor = self.sender.anchor()
        if anchor is not None and Purpose.ANCHOR not in self._outstanding:
            self._announced_at = now
            self._send(Purpose.ANCHOR, [anchor])

    def _resting(self, now: float) -> bool:
        """True if changes have just told everybody what an anchor would. After the clock jumped back nobody knows."""
        period = self._anchor_timer.period
        return (
            not self._undelivered
            and 0.0 <= now - self._news_at < bounds.ANCHOR_REST * period
            and 0.0 <= now - self._announced_at < bounds.LONGEST_ANCHOR_REST * period
        )

    def _send(self, purpose: Purpose, payloads: Sequence[Payload]) -> None:
        self._sends += 1
        self._outstanding.add(purpose)
        self._effects.append(Send(self._sends, purpose, self._destination, tuple(payloads)))

    def _of_former_run(self, send: Send) -> bool:
        return any(isinstance(each, (Anchor, Tile)) and each.boot != self.sender.boot for each in send.payloads)

    def _warn_once(self, subject: str, text: str) -> None:
        if subject not in self._said:
            self._said.add(subject)
            self._effects.append(Note(text, warning=True))


def _numbers(payloads: Sequence[Payload]) -> List[int]:
    return [number for payload in payloads if isinstance(payload, Tile) for number in payload.numbers]
