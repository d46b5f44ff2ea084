"""Strategies 5 and 6: the nearest or any cluster that no other robot has announced (contract 3.5, 3.6)."""

from typing import List, Optional

from explorer.clusters import Cluster
from explorer.scene import Scene
from explorer.strategies.strategy import Allocation, Bids, ClusterStrategy, registered

# Share of a cluster's elements that another robot has announced from which on it is refused (contract 3.6).
ANNOUNCED_SHARE = 0.1


class Negotiated(ClusterStrategy):
    allocation = Allocation.NEGOTIATED

    def order(self, scene: Scene) -> List[Cluster]:
        """The open clusters, best first."""
        raise NotImplementedError

    def choose(self, scene: Scene, bids: Bids) -> Optional[Cluster]:
        return next((cluster for cluster in self.order(scene) if not _is_announced(scene, cluster)), None)


def _is_announced(scene: Scene, cluster: Cluster) -> bool:
    return any(claim.share_of(cluster) >= ANNOUNCED_SHARE for claim in scene.claims.values())


@registered
class NearestCluster(Negotiated):
    number = 5
    name = "nearest_cluster"
    title = "nearest cluster with negotiation"

    def order(self, scene: Scene) -> List[Cluster]:
        return sorted(scene.open, key=lambda cluster: (self.bid(scene, cluster), cluster.number))


@registered
class RandomCluster(Negotiated):
    number = 6
    name = "random_cluster"
    title = "random cluster with negotiation"

    def order(self, scene: Scene) -> List[Cluster]:
        return [scene.open[index] for index in self._random.permutation(len(scene.open))]
