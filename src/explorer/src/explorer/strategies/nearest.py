"""Strategy 3: the frontier that is nearest in a straight line (contract 3.5)."""

from typing import List, Sequence

from explorer.frontiers import Frontier
from explorer.geometry import distance
from explorer.scene import Scene
from explorer.strategies.strategy import FrontierStrategy, registered


@registered
class Nearest(FrontierStrategy):
    number = 3
    name = "nearest"
    title = "nearest frontier, Euclidean"

    def order(self, scene: Scene, frontiers: Sequence[Frontier]) -> List[Frontier]:
        return sorted(frontiers, key=lambda f: distance(scene.place, (f.x, f.y)))
