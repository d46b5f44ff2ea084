"""What came of an auction: all bids, those that lost, too, and who explores what."""

from dataclasses import dataclass
from typing import Mapping, Tuple

from explorer.auction import OpenAuction
from explorer.geometry import Position
from explorer.scene import Scene


@dataclass(frozen=True)
class Offer:
    """A cluster: `place` in m when the auction began; {robot: bid}; the robot that explores it, empty: none."""

    place: Position
    bids: Mapping[str, float]
    explored_by: str


@dataclass(frozen=True)
class AuctionResult:
    """`unit`: what the bids are counted in."""

    auction_id: int
    unit: int
    offers: Tuple[Offer, ...]


def result_of(auction: OpenAuction, own_bids: Mapping[int, float], unit: int, scene: Scene) -> AuctionResult:
    """`own_bids`: {cluster number: bid} of the auctioneer. `scene`: after its choice."""
    claimed = scene.claimed
    offers = []
    for number, place in auction.places.items():
        bids = {scene.name: own_bids[number]} if number in own_bids else {}
        bids.update({robot: offered[number] for robot, offered in auction.bids.items() if number in offered})
        explored_by = scene.name if number == scene.own else claimed.get(number, "")
        offers.append(Offer(place, bids, explored_by))
    return AuctionResult(auction.auction_id, unit, tuple(offers))
