"""Clusters by auction: when one is held, what its outcome means, ties (contract 3.7)."""

import math
from typing import Optional

from explorer.auction import closing_message
from explorer.auctions import Auctions
from explorer.claim import OwnClaim
from explorer.clusters import Cluster
from explorer.driver import Driver
from explorer.messages import Emit, SendAuction
from explorer.recognition import Recognition
from explorer.scene import Scene
from explorer.selection import Selection
from explorer.sharing import SHARE_PERIOD, Sharing
from explorer.strategies.strategy import Bids, ClusterStrategy
from explorer.team import Team

CONFIRM_PERIOD = 8.0  # s after which a claim is confirmed
REASSIGN_PERIOD = 5.0  # s between two auctions while the robot drives
RETRY_PERIOD = 1.0  # s between two auctions while the robot waits
OTHERS_PAUSE = 0.5  # s to wait for the outcome of another robot's auction
PATIENCE = 4.0  # s after which a cluster that nobody claims is taken by a robot that has none
LONG_PATIENCE = 12.0  # s after which it takes one that is claimed by a robot farther away
NEARER = 0.5  # m by which it must be nearer


class AuctionedSelection(Selection):
    """The robot stays in its cluster until it is empty or given up, then holds an auction."""

    def __init__(
        self,
        strategy: ClusterStrategy,
        driver: Driver,
        claim: OwnClaim,
        auctions: Auctions,
        sharing: Sharing,
        team: Team,
        name: str,
        emit: Emit,
    ) -> None:
        super().__init__(driver)
        self._strategy, self._claim, self._auctions = strategy, claim, auctions
        self._sharing, self._team = sharing, team
        self._name, self._emit = name, emit
        self._asked_at = -math.inf

    def select(self, scene: Scene) -> None:
        if self._on_its_way(scene):
            return
        current = scene.current
        if current is not None:
            self._drive_in(current, scene)
        elif scene.open:
            # When every cluster is claimed an auction leads to nothing, however often it is held.
            if not self._auctions.open and scene.now - self._asked_at >= RETRY_PERIOD:
                self._need_cluster(scene)
        else:
            self._stop_if_over(scene)

    def close(self, auction_id: int, bids: Bids, scene: Scene) -> None:
        """The own auction has ended with these bids."""
        self._take(self._strategy.choose(scene, bids), scene)
        self._announce(scene, auction_id)

    def confirm(self, scene: Scene) -> None:
        age = scene.now - self._claim.told_at
        if self._team.alone or self._auctions.open or age < SHARE_PERIOD:
            return
        own = scene.cluster(self._claim.number)
        if self._claim.changed(own) or (own is not None and age >= CONFIRM_PERIOD):
            self._announce(scene, self._auctions.last_id)

    def finish(self, scene: Scene) -> None:
        self._auctions.abandon()
        if not self._team.alone:
            self._announce(scene, self._auctions.last_id)

    def settle(self, robot: str, scene: Scene) -> None:
        """Two robots chose the same cluster at once: the lower bid keeps it, on equal bids the lesser name. Both
        compare what they told when they asked: by bids of now, both would keep it."""
        own = scene.cluster(self._claim.number)
        claim = self._team.claims(scene.now).get(robot)
        if claim is None or own is None:
            return
        meant = Recognition(scene.clusters).match(scene.claims[robot])
        if meant is None or meant.number != own.number:
            return
        mine = self._own_bid(own, scene)
        if (mine, self._name) <= (self._bid_of(robot, claim.bid, own, scene), robot):
            self._claim.told_at = min(self._claim.told_at, scene.now - CONFIRM_PERIOD + 1.0)
        else:
            self._claim.lose()
            self._asked_at = -math.inf

    def _own_bid(self, cluster: Cluster, scene: Scene) -> float:
        if not cluster.reachable:
            return math.inf
        told = self._auctions.told.get(cluster.number)
        return self._strategy.bid(scene, cluster) if told is None else told

    def _bid_of(self, robot: str, told: Optional[float], cluster: Cluster, scene: Scene) -> float:
        if told is not None and told >= 0:
            return told
        position = scene.positions.get(robot)
        return math.inf if position is None else self._strategy.estimate(scene, position, cluster)

    def _need_cluster(self, scene: Scene) -> None:
        """Opens an auction, or decides at once where nobody would answer."""
        self._asked_at = scene.now
        if not self._team.bidders():
            self._take(self._strategy.choose(scene, {}), scene)
            return
        if self._auctions.others_open(scene.now) and self._driver.goal is not None:
            self._asked_at = scene.now - REASSIGN_PERIOD + OTHERS_PAUSE
            return
        self._sharing.share(scene.now, force=True)
        bids = {cluster.number: self._strategy.bid(scene, cluster) for cluster in scene.open}
        self._auctions.start(scene.open, bids, scene.now)

    def _take(self, cluster: Optional[Cluster], scene: Scene) -> None:
        """Takes the cluster that was decided on. A robot that goes empty-handed while a cluster stays unclaimed takes
        it after a while: the robot it was meant for does not know it or does not come."""
        if cluster is None and self._claim.idle(scene.now) >= PATIENCE:
            free = [(self._strategy.bid(scene, c), c.number, c) for c in scene.open if c.number not in scene.claimed]
            cluster = min(free)[2] if free else None
        self._claim.take(cluster, scene.now)

    def _announce(self, scene: Scene, auction_id: int) -> None:
        told = self._claim.tell(scene.cluster(self._claim.number), scene.now)
        self._sharing.share(scene.now, force=True)
        self._emit(SendAuction(closing_message(self._name, auction_id, told)))


class ContinuousSelection(AuctionedSelection):
    """The goal follows its frontier while the map grows, and clusters are shared out anew while driving."""

    def _take(self, cluster: Optional[Cluster], scene: Scene) -> None:
        """A robot that stands nearer than the one that claims a cluster may stand in its way, as in a door; then both
        would wait for ever."""
        if cluster is None and self._claim.idle(scene.now) >= LONG_PATIENCE:
            nearer = [each for each in scene.open if self._is_nearer(each, scene)]
            cluster = min(nearer, key=lambda each: (each.cost, each.number)) if nearer else None
        super()._take(cluster, scene)

    def _is_nearer(self, cluster: Cluster, scene: Scene) -> bool:
        """Than the robot that claims the cluster."""
        position = scene.positions.get(scene.claimed.get(cluster.number, ""))
        if position is None:
            return False
        here, there = (self._strategy.estimate(scene, place, cluster) for place in (scene.place, position))
        return here + NEARER < there

    def select(self, scene: Scene) -> None:
        current, clusters = scene.current, scene.open
        if current is None and clusters:
            current = self._find_cluster(scene)
        elif len(clusters) > 1 and not self._auctions.open and scene.now - self._asked_at >= REASSIGN_PERIOD:
            self._need_cluster(scene)
            current = self._current(scene)
        if current is not None:
            self._follow(current, scene)
        else:
            self._stop_if_over(scene)

    def _find_cluster(self, scene: Scene) -> Optional[Cluster]:
        if not self._auctions.open and scene.now - self._asked_at >= RETRY_PERIOD:
            self._need_cluster(scene)
        current = self._current(scene)
        if current is None and (self._auctions.open or self._driver.goal is None):
            # While the bids are on their way, the likely outcome is better than standing still.
            self._take(self._strategy.choose(scene, {}), scene)
            current = self._current(scene)
        return current

    def _current(self, scene: Scene) -> Optional[Cluster]:
        """The own cluster as it is now."""
        return next((cluster for cluster in scene.open if cluster.number == self._claim.number), None)

    def _follow(self, cluster: Cluster, scene: Scene) -> None:
        """Keeps the goal at the cluster's viewpoint, without new goals for small changes."""
        ready = {member.number: member for member in cluster.members if member.number in scene.ready}
        if not ready:
            return
        target = ready.get(cluster.target if cluster.target is not None else -1)
        if target is None:
            target = ready[min((cluster.views[number][2], number) for number in ready)[1]]
        goal = self._driver.goal
        if goal is None or goal.cluster != cluster.number or not self._still_good(target.number, scene):
            self._drive_to(target, cluster.number, scene)

    def _still_good(self, target: int, scene: Scene) -> bool:
        """True if the goal serves as well as the one for `target` would."""
        goal = self._driver.goal
        assert goal is not None
        x, y, _ = scene.views[target]
        if math.hypot(goal.pose.x - x, goal.pose.y - y) < 0.6:
            return goal.frontier == target or self._on_its_way(scene)
        return self._on_its_way(scene) and scene.now - goal.sent < 2.0
