"""The auctions under way: the own one, those of others and the bids that they told (contract 3.7)."""

from typing import Callable, Dict, Mapping, Optional, Sequence

from explorer.auction import OpenAuction, reply_message
from explorer.clusters import Cluster
from explorer.foreign import ForeignFrontiers
from explorer.messages import Auction, Bid, Emit, SendAuction
from explorer.recognition import Recognition, listed
from explorer.team import Team

MAXIMUM_BIDS = 500  # of one message that are read


class Auctions:
    """`last_id`: of the auctions of a former mission. `unit`: of the own bids."""

    def __init__(self, name: str, team: Team, timeout: float, emit: Emit, last_id: int, unit: int) -> None:
        self._name, self._team, self._timeout, self._emit = name, team, timeout, emit
        self.last_id, self._unit = last_id, unit
        self.completed = self.uncompleted = 0
        self.heard: Dict[str, Dict[int, float]] = {}  # {robot: {cluster number: bid}} of the last own auction
        self.told: Dict[int, float] = {}  # {cluster number: own bid} of the last own auction, as the others were told
        self._own: Optional[OpenAuction] = None
        self._others: Dict[str, float] = {}  # {robot: when its auction closes at the latest}

    @property
    def open(self) -> bool:
        """The own one."""
        return self._own is not None

    def others_open(self, now: float) -> bool:
        self._others = {robot: until for robot, until in self._others.items() if until > now}
        return bool(self._others)

    def start(self, clusters: Sequence[Cluster], own_bids: Mapping[int, float], now: float) -> None:
        """Opens an auction of these clusters. The others must know their frontiers."""
        self.last_id = (self.last_id + 1) % 2**32
        deadline = now + self._timeout
        self._own = OpenAuction(self.last_id, clusters, self._name, self._team.bidders(), deadline, self._unit)
        self.told = dict(own_bids)
        self._emit(SendAuction(self._own.start_message(self.told)))

    def take_bids(self, reply: Auction) -> bool:
        """True if the own auction has all its bids with these. What others bid in auctions of others is no news."""
        return self._own is not None and self._own.add(reply) and not self._own.missing()

    def close_if_complete(self, now: float) -> Optional[OpenAuction]:
        """The own auction with all its bids, once it is over."""
        auction = self._own
        if auction is None or not auction.complete(now):
            return None
        self._own, self.heard = None, auction.bids
        for robot in auction.missing():
            peer = self._team.peer(robot)
            if peer is not None:
                peer.unanswered += 1
        self.completed += bool(auction.bids)
        self.uncompleted += not auction.bids
        return auction

    def abandon(self) -> None:
        """Bids are of no use any more."""
        self._own = None

    def take_start(self, auction: Auction, now: float) -> None:
        """Another robot's auction is open; its own bids settle overlapping ones if they can be compared."""
        self._others[auction.robot] = now + self._timeout
        peer = self._team.peer(auction.robot)
        if peer is not None:
            told = auction.requested[:MAXIMUM_BIDS] if auction.unit == self._unit else ()
            peer.bids = {frozenset(bid.elements): bid.bid for bid in told}

    def take_end(self, auction: Auction) -> Optional[float]:
        """Another robot's auction is over; the bid that it told for the cluster it took, if it did."""
        self._others.pop(auction.robot, None)
        peer = self._team.peer(auction.robot)
        told = None
        occupied = set(auction.occupied)
        for elements, bid in peer.bids.items() if peer is not None else ():
            if len(occupied & elements) * 2 > len(occupied):
                told = bid
        return told

    def refuse(self, auction: Auction) -> None:
        """An answer without bids: this robot is not waited for, nor counted."""
        self._emit(SendAuction(reply_message(self._name, auction.auction_id, [])))

    def answer(
        self,
        auction: Auction,
        candidates: Sequence[Cluster],
        bid_for: Callable[[Cluster], float],
        foreign: ForeignFrontiers,
    ) -> None:
        """A bid for each cluster on offer that is one of the own ones (40 % rule), -1 for the others."""
        available, recognition = [], Recognition(candidates)
        for bid in auction.requested[:MAXIMUM_BIDS]:
            cluster = recognition.match(listed(bid.elements, foreign, self._name))
            available.append(Bid(bid.elements, -1.0 if cluster is None else bid_for(cluster)))
        self._emit(SendAuction(reply_message(self._name, auction.auction_id, available, self._unit)))


def comparable(auction: Auction, foreign: ForeignFrontiers, own_name: str) -> bool:
    """True if this robot can place any of the frontiers on offer."""
    robots = {key[0] for bid in auction.requested for key in bid.elements}
    return any(robot == own_name or foreign.has_transform(robot) for robot in robots)
