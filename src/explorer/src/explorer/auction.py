"""One auction of this robot's clusters, from the start message to the closing one (contract 3.7)."""

import zlib
from typing import Dict, Sequence, Set, Tuple

from explorer.clusters import Cluster
from explorer.foreign import Key
from explorer.messages import PAPER_UNIT, Auction, Bid


def first_auction_id(robot_name: str, robot_number: int, simulation: bool) -> int:
    """Start of the counter of auctions. In simulation 10000 * robot number (contract 3.7); on real robots a hash of
    the name in the upper half, because replies reach every robot and carry no auctioneer."""
    if simulation:
        return 10000 * robot_number
    return (zlib.crc32(robot_name.encode()) & 0xFFFF) << 16


class OpenAuction:
    """Clusters on offer, the bids so far, and when to close.

    Bids in another `unit` say that the robot has answered, no more: it is judged by its place, as one without bids.
    Duplicates, late bids, bids for other auctions and bids for clusters not on offer are ignored.
    """

    def __init__(
        self,
        auction_id: int,
        clusters: Sequence[Cluster],
        own_name: str,
        bidders: Set[str],
        deadline: float,
        unit: int = PAPER_UNIT,
    ) -> None:
        self.auction_id = auction_id
        self.deadline = deadline
        self.unit = unit
        self.bids: Dict[str, Dict[int, float]] = {}
        self.places = {cluster.number: cluster.place for cluster in clusters}  # m
        self._own_name = own_name
        self._awaited = set(bidders)
        self._strangers: Set[str] = set()
        self._rows: Dict[Tuple[Key, ...], int] = {}
        for cluster in clusters:
            self._rows[elements_of(cluster, own_name)] = cluster.number

    def start_message(self, own_bids: Dict[int, float]) -> Auction:
        """The original leaves the auctioneer's bids unset; told along, they settle overlapping auctions."""
        requested = tuple(Bid(elements, own_bids.get(number, -1.0)) for elements, number in self._rows.items())
        return Auction(self._own_name, self.auction_id, status=True, start=True, requested=requested, unit=self.unit)

    def add(self, reply: Auction) -> bool:
        """Takes the bids of one robot; False if they are not for this auction, came before or are in another unit."""
        if reply.auction_id != self.auction_id or reply.status or reply.robot in self.bids:
            return False
        if reply.available and reply.unit != self.unit:
            self._strangers.add(reply.robot)
            return False
        offered = {}
        for bid in reply.available:
            number = self._rows.get(bid.elements)
            if number is not None and bid.bid >= 0:
                offered[number] = bid.bid
        self.bids[reply.robot] = offered
        return True

    def missing(self) -> Set[str]:
        return self._awaited - set(self.bids) - self._strangers

    def complete(self, now: float) -> bool:
        return not self.missing() or now >= self.deadline


def elements_of(cluster: Cluster, own_name: str) -> Tuple[Key, ...]:
    return tuple((own_name, number) for number in sorted(cluster.numbers))


def closing_message(own_name: str, auction_id: int, occupied: Sequence[Key]) -> Auction:
    """Closes an auction, or confirms a claim between auctions. No elements: the robot explores no cluster."""
    return Auction(own_name, auction_id, status=True, finished=True, occupied=tuple(occupied))


def reply_message(own_name: str, auction_id: int, available: Sequence[Bid], unit: int = PAPER_UNIT) -> Auction:
    return Auction(own_name, auction_id, status=False, available=tuple(available), unit=unit)
