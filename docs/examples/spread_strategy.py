"""A strategy of one's own: each robot takes the cluster that is near to it and far from the others."""

from typing import Optional

from explorer.clusters import Cluster
from explorer.geometry import Position, distance
from explorer.scene import Scene
from explorer.strategies.strategy import Allocation, Bids, ClusterStrategy, registered


@registered
class Spread(ClusterStrategy):
    number, name, title = 100, "spread", "near clusters that are far from the other robots"
    allocation = Allocation.AUCTIONED
    unit = 100  # its bids are metres, not the paper's squared metres

    def bid(self, scene: Scene, cluster: Cluster) -> float:
        return cluster.cost  # m of way from this robot

    def estimate(self, scene: Scene, position: Position, cluster: Cluster) -> float:
        return distance(position, cluster.place)  # for a robot that has told no bid

    def choose(self, scene: Scene, bids: Bids) -> Optional[Cluster]:
        free = [cluster for cluster in scene.open if cluster.number not in scene.claimed]
        return min(free, key=lambda cluster: self._costs(scene, bids, cluster), default=None)

    def _costs(self, scene: Scene, bids: Bids, cluster: Cluster) -> float:
        others = [
            bids.get(robot, {}).get(cluster.number, self.estimate(scene, position, cluster))
            for robot, position in scene.positions.items()
        ]
        return self.bid(scene, cluster) - 0.5 * min(others, default=0.0)
