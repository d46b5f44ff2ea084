"""The way of selecting goals that goes with a strategy."""

from explorer.auctions import Auctions
from explorer.bidding import AuctionedSelection, ContinuousSelection
from explorer.claim import OwnClaim
from explorer.driver import Driver
from explorer.messages import Emit
from explorer.negotiation import NegotiatedSelection
from explorer.selection import FrontierSelection, Selection
from explorer.sharing import Sharing
from explorer.strategies.strategy import Allocation, ClusterStrategy, FrontierStrategy, Strategy
from explorer.team import Team


def selection_for(
    strategy: Strategy,
    driver: Driver,
    claim: OwnClaim,
    auctions: Auctions,
    sharing: Sharing,
    team: Team,
    name: str,
    emit: Emit,
) -> Selection:
    if isinstance(strategy, FrontierStrategy):
        return FrontierSelection(strategy, driver)
    assert isinstance(strategy, ClusterStrategy)
    if strategy.allocation == Allocation.NEGOTIATED:
        return NegotiatedSelection(strategy, driver, claim, team, name, emit)
    kind = ContinuousSelection if strategy.allocation == Allocation.CONTINUOUS else AuctionedSelection
    return kind(strategy, driver, claim, auctions, sharing, team, name, emit)
