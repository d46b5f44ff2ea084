"""Clusters by negotiation (contract 3.6): what a robot has chosen is announced and left to it."""

from explorer.claim import OwnClaim
from explorer.clusters import Cluster
from explorer.driver import Driver
from explorer.messages import Emit, SendFrontiers
from explorer.scene import Scene
from explorer.selection import Selection
from explorer.sharing import elements
from explorer.strategies.strategy import ClusterStrategy
from explorer.team import Team

CONFIRM_PERIOD = 8.0  # s after which a choice is announced again


class NegotiatedSelection(Selection):
    def __init__(
        self, strategy: ClusterStrategy, driver: Driver, claim: OwnClaim, team: Team, name: str, emit: Emit
    ) -> None:
        super().__init__(driver)
        self._strategy, self._claim, self._team = strategy, claim, team
        self._name, self._emit = name, emit

    def select(self, scene: Scene) -> None:
        if self._on_its_way(scene):
            return
        current = scene.current
        if current is None and scene.open:
            current = self._strategy.choose(scene, {})
            if current is not None:
                self._claim.take(current, scene.now)
                self._announce(current, scene.now)
        if current is not None:
            self._drive_in(current, scene)
        else:
            self._stop_if_over(scene)

    def confirm(self, scene: Scene) -> None:
        cluster = scene.cluster(self._claim.number)
        if self._team.alone or cluster is None or not cluster.reachable:
            return
        if scene.now - self._claim.told_at >= CONFIRM_PERIOD:
            self._announce(cluster, scene.now)

    def _announce(self, cluster: Cluster, now: float) -> None:
        self._claim.tell(cluster, now)
        self._emit(SendFrontiers("negotiation_list", elements(self._name, cluster.members)))
