"""Strategy 4: any frontier (contract 3.5)."""

from typing import List, Sequence

from explorer.frontiers import Frontier
from explorer.scene import Scene
from explorer.strategies.strategy import FrontierStrategy, registered


@registered
class RandomFrontier(FrontierStrategy):
    number = 4
    name = "random_frontier"
    title = "random frontier"

    def order(self, scene: Scene, frontiers: Sequence[Frontier]) -> List[Frontier]:
        return [frontiers[index] for index in self._random.permutation(len(frontiers))]
