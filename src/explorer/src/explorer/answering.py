"""What a robot makes of the auctions of others: bids, claims, answers."""

from explorer.auctions import Auctions, comparable
from explorer.foreign import ForeignFrontiers
from explorer.messages import Auction
from explorer.perception import Perception
from explorer.scene_maker import SceneMaker
from explorer.selection import Selection
from explorer.senses import Senses
from explorer.strategies.strategy import Strategy
from explorer.team import Team

MAXIMUM_CLAIMED = 5000  # elements of one claim that are read


class Answering:
    def __init__(
        self,
        name: str,
        strategy: Strategy,
        senses: Senses,
        perception: Perception,
        foreign: ForeignFrontiers,
        team: Team,
        auctions: Auctions,
        selection: Selection,
        scenes: SceneMaker,
    ) -> None:
        self._name, self._strategy, self._auctions, self._team = name, strategy, auctions, team
        self._senses, self._perception, self._foreign = senses, perception, foreign
        self._selection, self._scenes = selection, scenes

    def take(self, auction: Auction, at_rest: bool, now: float) -> bool:
        """`at_rest`: this robot explores no more, or may not. True if the next step should not wait."""
        if auction.robot == self._name or self._team.peer(auction.robot) is None:
            return False
        self._team.heard(auction.robot)
        if not auction.status:
            complete = self._auctions.take_bids(auction)
            # Without a transform nobody can tell what is on offer.
            known = self._foreign.has_transform(auction.robot)
            self._team.answered(auction.robot, bool(auction.available) or not known)
            return complete
        if auction.start:
            self._answer(auction, at_rest, now)
        elif auction.finished:
            bid = self._auctions.take_end(auction)
            self._team.claim(auction.robot, auction.occupied[:MAXIMUM_CLAIMED], now, bid)
            if self._perception.ways is not None and self._senses.pose is not None:
                self._selection.settle(auction.robot, self._scenes.scene(now))
        return True

    def _answer(self, auction: Auction, at_rest: bool, now: float) -> None:
        self._auctions.take_start(auction, now)
        if at_rest or self._senses.pose is None or not comparable(auction, self._foreign, self._name):
            self._auctions.refuse(auction)
        elif self._perception.ways is None:
            self._auctions.answer(auction, (), lambda _: -1.0, self._foreign)
        else:
            scene = self._scenes.scene(now)
            self._auctions.answer(auction, scene.candidates, lambda c: self._strategy.bid(scene, c), self._foreign)
