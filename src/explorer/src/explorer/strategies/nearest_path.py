"""Strategy 0: the frontier with the shortest way (contract 3.5)."""

from typing import List, Sequence

from explorer.frontiers import Frontier
from explorer.scene import Scene
from explorer.strategies.strategy import FrontierStrategy, registered


@registered
class NearestPath(FrontierStrategy):
    number = 0
    name = "nearest_path"
    title = "nearest frontier by travel path"

    def order(self, scene: Scene, frontiers: Sequence[Frontier]) -> List[Frontier]:
        return sorted(frontiers, key=lambda frontier: scene.views[frontier.number][2])
