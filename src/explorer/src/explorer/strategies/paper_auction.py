"""Strategy 1: the auction of the paper (contract 3.7)."""

from typing import Optional

import numpy as np

from explorer.assignment import assigned
from explorer.clusters import Cluster
from explorer.scene import Scene
from explorer.strategies.others import costs_of_others
from explorer.strategies.strategy import Allocation, Bids, ClusterStrategy, registered


@registered
class PaperAuction(ClusterStrategy):
    """Used clusters cost too much for every robot; with fewer clusters than robots the nearest one is taken."""

    number = 1
    name = "auction"
    title = "auction of clusters, Hungarian assignment (the paper's form)"
    allocation = Allocation.AUCTIONED

    def choose(self, scene: Scene, bids: Bids) -> Optional[Cluster]:
        robots, costs = costs_of_others(scene, bids, self)
        free = [row for row, cluster in enumerate(scene.open) if cluster.number not in scene.claimed]
        clusters = [scene.open[row] for row in free]
        if not clusters:
            return None
        own = np.array([self.bid(scene, cluster) for cluster in clusters], dtype=float)
        if len(scene.open) < len(robots) + 1:
            return clusters[int(np.argmin(own))]
        row = assigned(costs[free], own)
        return None if row is None else clusters[row]
