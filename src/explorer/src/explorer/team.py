"""What this robot knows of the others: who there is, where they were last, and which frontiers they have claimed."""

import math
from dataclasses import dataclass, field
from typing import Dict, List, Mapping, Optional, Sequence, Set, Tuple

from explorer.foreign import Key

Position = Tuple[float, float]

# A position older than this is of no use for a bid, in seconds.
POSITION_LIFETIME = 30.0

# A robot that left so many auctions unanswered is not waited for until it is heard again.
SILENT_AFTER = 2

# A robot confirms its claim every 8 s (contract 3.7); later than this in seconds, and with an auction unanswered, it is
# taken for dead.
OVERDUE = 9.5

# Robots beyond this number are not remembered; it bounds every table here.
MAXIMUM_ROBOTS = 100


@dataclass(frozen=True)
class Claim:
    """The elements of the cluster that a robot explores, since or confirmed at `time`, and its bid if it told one."""

    elements: Tuple[Key, ...]
    time: float
    bid: Optional[float] = None


@dataclass
class Peer:
    """One other robot. `known`: the radio announces it now. Times are in seconds, positions in the own frame."""

    known: bool = False
    position: Optional[Position] = None
    position_time: float = -math.inf
    claim: Optional[Claim] = None
    bids: Dict[frozenset, float] = field(default_factory=dict)
    unanswered: int = 0
    refuses: bool = False  # its last answer to an auction held no bids


class Team:
    """Table of the other robots, bounded; names come from the messages of the radio."""

    def __init__(self, own_name: str, claim_timeout: float) -> None:
        self._own_name = own_name
        self._claim_timeout = claim_timeout
        self._peers: Dict[str, Peer] = {}

    def peer(self, name: str) -> Optional[Peer]:
        """The entry of a robot, made when it is new; None for the own name or when the table is full."""
        if name == self._own_name or not name:
            return None
        if name not in self._peers:
            if len(self._peers) >= MAXIMUM_ROBOTS and not self._make_room():
                return None
            self._peers[name] = Peer()
        return self._peers[name]

    def _make_room(self) -> bool:
        """The robot that was heard of first among those that have left is forgotten."""
        gone = next((name for name, peer in self._peers.items() if not peer.known), None)
        if gone is not None:
            del self._peers[gone]
        return gone is not None

    def set_known(self, names: Sequence[str]) -> Tuple[List[str], List[str]]:
        """Takes the robots the radio knows now; returns those that came, as far as there is room, and those that
        left."""
        now_known = {name for name in names if name and name != self._own_name}
        left = sorted(name for name, peer in self._peers.items() if peer.known and name not in now_known)
        for name in left:
            self._peers[name].known = False
            self._peers[name].claim = None
        came = []
        for name in sorted(now_known):
            peer = self.peer(name)
            if peer is not None and not peer.known:
                peer.known, peer.unanswered = True, 0
                came.append(name)
        return came, left

    def set_positions(self, positions: Mapping[str, Position], now: float) -> None:
        for name, position in sorted(positions.items()):
            peer = self.peer(name)
            if peer is not None:
                peer.position, peer.position_time = (float(position[0]), float(position[1])), now

    def answered(self, name: str, with_bids: bool) -> None:
        """A robot has answered an auction."""
        peer = self.peer(name)
        if peer is not None:
            peer.refuses = not with_bids

    def rests(self, name: str) -> bool:
        """True if a robot has told that it explores nothing and bids for nothing: it has finished, or is paused."""
        peer = self._peers.get(name)
        return peer is not None and peer.refuses and peer.claim is None

    def heard(self, name: str) -> None:
        peer = self.peer(name)
        if peer is not None:
            peer.known, peer.unanswered = True, 0

    def claim(self, name: str, elements: Sequence[Key], now: float, bid: Optional[float] = None) -> None:
        """A robot announces the elements of its cluster; none: it has given up its claim."""
        peer = self.peer(name)
        if peer is not None:
            peer.claim = Claim(tuple(elements), now, bid) if elements else None

    def claims(self, now: float) -> Dict[str, Claim]:
        """The claims that hold: of robots that are there, confirmed within the time limit."""
        return {
            name: peer.claim
            for name, peer in sorted(self._peers.items())
            if peer.known and peer.claim is not None and self._holds(peer, peer.claim, now)
        }

    def _holds(self, peer: Peer, claim: Claim, now: float) -> bool:
        limit = self._claim_timeout if peer.unanswered == 0 else min(OVERDUE, self._claim_timeout)
        return now - claim.time <= limit

    def positions(self, now: float) -> Dict[str, Position]:
        """Positions in metres in the own frame that are young enough to be used, also of robots out of range."""
        return {
            name: peer.position
            for name, peer in sorted(self._peers.items())
            if peer.position is not None and now - peer.position_time <= POSITION_LIFETIME
        }

    @property
    def alone(self) -> bool:
        """True if none is known."""
        return not any(peer.known for peer in self._peers.values())

    def known(self) -> List[str]:
        return sorted(name for name, peer in self._peers.items() if peer.known)

    def bidders(self) -> Set[str]:
        """The robots an auction waits for: known ones that have answered lately."""
        return {name for name, peer in self._peers.items() if peer.known and peer.unanswered < SILENT_AFTER}

    def competitors(self, now: float) -> List[str]:
        """The robots that may take a cluster: known, and lately heard or with a claim that holds. A robot that has
        missed one auction is counted with interpolated bids; one that never answers must not block a cluster."""
        claims = self.claims(now)
        return sorted(
            name
            for name, peer in self._peers.items()
            if peer.known and (peer.unanswered < SILENT_AFTER or name in claims)
        )
