"""The exchange of maps with all other robots: the own one goes out, theirs come in, and losses are repaired."""

from typing import Dict, List, Optional, Sequence, Tuple

import numpy as np

from mr_grid import GridError, GridInfo, OccupancyGrid

from ..effects import Effect, Note, Outcome, Purpose, Send
from ..grid import Box
from ..messages import NO_BOOT, USUAL_RESOLUTION_M, Anchor, Boot, Request, Tile
from ..options import Options
from ..payload import Payload
from ..timer import Timer
from ..topology import topology_of
from . import bounds
from .broadcast import Broadcast
from .peer_map import PeerMap
from .retry import Retry
from .sender import MapSender


class _Peer:
    """What is exchanged with one robot."""

    def __init__(self, name: str) -> None:
        self.map = PeerMap(name)
        self.present = True
        self.answering = False
        self.asking = False
        self.complained = False
        self.failures = 0
        self.retry = Retry(bounds.FIRST_PAUSE_S, bounds.LONGEST_REQUEST_PAUSE_S, bounds.STEADY_REQUESTS)

    def heard(self) -> None:
        """Something came from the robot: if it was lost, what is missing is asked for at once."""
        if not self.present:
            self.retry.at_once()
        self.present = True

    def progress(self, now: float) -> None:
        """Something came that concerns maps: it may be asked soon, unless its map does not fit in here."""
        self.heard()
        if not self.complained:
            self.retry.progress(now)


class Exchange:
    """Owns the own map's sender, the maps of all others, and everything that is under way between them.

    Calls take the present time in seconds; then collect `effects()`: sends, whose ends come back by `on_sent`, and
    notes. Cells and boxes of another robot's map count from the corner of `lattice_of`.
    """

    def __init__(self, options: Options, boot: Boot) -> None:
        """`boot` names this run (see messages.Boot)."""
        self._name = options.robot_name
        self._topology = topology_of(options)
        self._broadcast = Broadcast(options, boot)
        self._peers: Dict[str, _Peer] = {}
        self._effects: List[Effect] = []
        self._sends = 0
        self._full = False
        self._repair_timer = Timer(bounds.REPAIR_PERIOD_S)

    # What comes in

    def on_local_map(self, grid: OccupancyGrid) -> bool:
        """The local map changed. False, and a warning, if it has another resolution or heading than the first one."""
        return self._broadcast.on_map(grid, told=not self._topology.is_base)

    def on_merged_map(self, grid: OccupancyGrid) -> None:
        """On a base: the global map changed, which is the map that it tells. It is not drawn anew so often that this
        would have to wait; the robots' maps have waited before."""
        if self._broadcast.on_map(grid):
            self._broadcast.tell_at_once()

    @property
    def boot(self) -> Boot:
        """Names the run of the own map."""
        return self._sender.boot

    def begin_run(self, boot: Boot) -> None:
        """The own map begins anew, in another frame; `boot` names the new run."""
        self._broadcast.begin_run(boot)

    def resume(self, anchor: Anchor) -> None:
        """Before the first map: goes on with the run of the own map that had come so far."""
        self._sender.resume(anchor)

    def meet(self, name: str) -> bool:
        """Takes note of a robot; False for the own name, none, and one too many."""
        if not name or name == self._name:
            return False
        if name not in self._peers:
            if len(self._peers) >= bounds.MOST_ROBOTS:
                self._refuse(name)
                return False
            self._peers[name] = _Peer(name)
            self._effects.append(Note(f"{name} is new"))
        return True

    def on_robot(self, name: str, now: float, returned: bool = False) -> None:
        """A robot is there. `returned`: the radio announced it anew (new_robot), so what was sent last may be lost."""
        known = name in self._peers
        if not self.meet(name):
            return
        peer = self._peers[name]
        back = known and (returned or not peer.present)
        peer.present = True
        if back:
            peer.retry.at_once()
            self._broadcast.repeat_at_once()
            if self._topology.exchanges_maps_with(name):
                self._answer(name, self._sender.last())

    def on_robot_lost(self, name: str) -> None:
        """The radio lost the robot. Its map stays."""
        if name in self._peers:
            self._peers[name].present = False

    def forget(self, name: str) -> bool:
        """Nothing that came from the robot counts any more; False if it was not met."""
        return self._peers.pop(name, None) is not None

    def on_heard(self, name: str) -> None:
        """Anything else came from the robot."""
        if self.meet(name):
            self._peers[name].heard()

    def on_anchor(self, anchor: Anchor, now: float) -> None:
        """A robot announced its anchor."""
        if not self.meet(anchor.robot):
            return
        peer = self._peers[anchor.robot]
        restarted = peer.map.set_anchor(anchor, now, self._room_for(peer))
        if restarted:
            peer.complained = False
        peer.progress(now)
        if restarted:
            self._effects.append(Note(f"{anchor.robot} restarted: its former map is dropped"))

    def on_tile(self, tile: Tile, now: float) -> None:
        """Map cells of another robot arrived."""
        if not self.meet(tile.robot):
            return
        peer = self._peers[tile.robot]
        peer.heard()
        try:
            peer.map.add(tile, now, self._room_for(peer))
            peer.progress(now)
        except GridError as error:
            # It will not fit the next time either, so the pauses between requests for it go on growing.
            if not peer.complained:
                peer.complained = True
                self._effects.append(
                    Note(f"map update of {tile.robot} ignored, as further ones are: {error}", warning=True)
                )

    def on_request(self, request: Request, now: float) -> None:
        """A robot asks for updates: none listed = everything, first one -1 = ignore (contract 2.4)."""
        if not self.meet(request.robot) or (request.numbers and request.numbers[0] == -1):
            return
        if not self._topology.exchanges_maps_with(request.robot):
            return
        self._peers[request.robot].progress(now)
        tiles = self._sender.again(request.numbers) if request.numbers else self._sender.everything()
        self._answer(request.robot, tiles, always=not request.numbers)

    def on_sent(self, send: Send, outcome: Outcome, now: float) -> None:
        """The host finished a Send of this object."""
        if send.purpose in (Purpose.CHANGES, Purpose.ANCHOR):
            self._broadcast.on_sent(send, outcome, now)
            return
        if outcome.too_large is not None:
            self._broadcast.halve(outcome.too_large)
        if send.destination not in self._peers:
            return
        if send.purpose is Purpose.ANSWER:
            self._go_on(send, outcome)
        elif send.purpose is Purpose.REQUEST:
            self._peers[send.destination].asking = False

    def tick(self, now: float) -> None:
        """Does what is due."""
        base = self._topology.relies_on
        if base is None or self.present(base):
            self._broadcast.tick(now, bool(self._peers))
        if self._repair_timer.fires(now):
            for name, peer in self._peers.items():
                if self._topology.exchanges_maps_with(name):
                    self._repair(name, peer, now)

    def effects(self) -> List[Effect]:
        """What is to be done since the last call."""
        effects, self._effects = self._effects + self._broadcast.effects(), []
        return effects

    # What was received

    def robots(self) -> Tuple[str, ...]:
        """All robots met, in the order in which that was."""
        return tuple(self._peers)

    def present(self, robot: str) -> bool:
        """True if the radio has the robot, or it was heard since it lost it."""
        return robot in self._peers and self._peers[robot].present

    def map_of(self, robot: str) -> Optional[OccupancyGrid]:
        """The known part of the robot's map; None while nothing is known. The same object while it does not change."""
        return self._peers[robot].map.grid() if robot in self._peers else None

    def version_of(self, robot: str) -> int:
        """Grows with each change of the robot's map."""
        return self._peers[robot].map.version if robot in self._peers else 0

    def run_of(self, robot: str) -> int:
        """0 before the robot's first anchor; another number means that its map frame is a new one."""
        return self._peers[robot].map.run if robot in self._peers else 0

    def boot_of(self, robot: str) -> Boot:
        """The robot's present run as it names it; NO_BOOT before its first anchor."""
        return self._peers[robot].map.boot if robot in self._peers else NO_BOOT

    def is_over(self, robot: str, run: Boot) -> bool:
        """True for a former run of the robot."""
        return robot in self._peers and self._peers[robot].map.is_over(run)

    def lattice_of(self, robot: str) -> Optional[GridInfo]:
        """Corner and resolution of the robot's map, fixed per run; None before the first anchor."""
        return self._peers[robot].map.lattice if robot in self._peers else None

    def take_changed(self, robot: str) -> Optional[Box]:
        """Box around the cells that changed since the last call in the present run; None if none did."""
        return self._peers[robot].map.take_changed() if robot in self._peers else None

    def cells_of(self, robot: str, box: Box) -> np.ndarray:
        """Copy of these cells of a robot that was met, unknown where nothing is known. KeyError for other robots."""
        return self._peers[robot].map.cells(box)

    def missing(self, robot: str) -> Optional[Tuple[int, ...]]:
        """Update numbers of the robot that are known to be missing: () means all, None nothing."""
        return self._peers[robot].map.wanted() if robot in self._peers else ()

    @property
    def anchor(self) -> Optional[Anchor]:
        """That of the own map; None before the first one."""
        return self._sender.anchor()

    @property
    def updates(self) -> int:
        """Update numbers used so far for the own map."""
        return self._sender.updates

    @property
    def _sender(self) -> MapSender:
        return self._broadcast.sender

    # Repair

    def _repair(self, name: str, peer: _Peer, now: float) -> None:
        own = self.anchor
        # As the original does: its tiles do not tell how large their cells are.
        usual = USUAL_RESOLUTION_M if own is None else own.info.resolution
        if peer.map.expire(now, self._room_for(peer), usual):
            text = f"{name} announces no anchor: the corner of its map is taken for (0, 0) of its frame"
            self._effects.append(Note(text, warning=True))
        wanted = peer.map.wanted()
        if wanted is None:
            peer.complained = False
        elif peer.present and not peer.asking and peer.retry.ready(now):
            peer.asking = True
            self._send(Purpose.REQUEST, name, [Request(self._name, wanted)])

    def _answer(self, name: str, tiles: Sequence[Tile], always: bool = False) -> None:
        peer, anchor = self._peers[name], self._sender.anchor()
        if anchor is None or peer.answering or not (tiles or always):
            return
        peer.answering, peer.failures = True, 0
        self._send(Purpose.ANSWER, name, [anchor, *tiles])

    def _go_on(self, send: Send, outcome: Outcome) -> None:
        """One lost message does not end an answer, unless it is of a former run."""
        peer, run = self._peers[send.destination], self._sender.boot
        missed = [each for each in outcome.undelivered if isinstance(each, (Anchor, Tile)) and each.boot == run]
        peer.failures = 0 if len(missed) < len(send.payloads) else peer.failures + 1
        peer.answering = bool(missed) and peer.present and not outcome.too_large and peer.failures < bounds.ANSWER_TRIES
        if peer.answering:
            self._send(Purpose.ANSWER, send.destination, missed)

    def _send(self, purpose: Purpose, destination: str, payloads: Sequence[Payload]) -> None:
        self._sends += 1
        self._effects.append(Send(self._sends, purpose, destination, tuple(payloads)))

    def _room_for(self, peer: _Peer) -> int:
        """Cells that the map of the robot may have."""
        others = sum(other.map.stored for other in self._peers.values() if other is not peer)
        return min(bounds.MOST_MAP_CELLS, bounds.MOST_STORED_CELLS - others)

    def _refuse(self, name: str) -> None:
        if not self._full:
            text = f"{name} ignored, as are all further robots: there are {bounds.MOST_ROBOTS} already"
            self._effects.append(Note(text, warning=True))
        self._full = True
