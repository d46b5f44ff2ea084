"""How a strategy's choice becomes a goal. One class for each kind of allocation; this is the one without messages."""

import math
from typing import Optional, Sequence

from explorer.clusters import Cluster
from explorer.driver import Driver, Goal
from explorer.frontiers import Frontier
from explorer.geometry import distance
from explorer.scene import Scene
from explorer.strategies.strategy import Bids, FrontierStrategy
from mr_grid import Pose


class Selection:
    """What is done in each step while the robot explores; by default nothing is told to the others."""

    def __init__(self, driver: Driver) -> None:
        self._driver = driver

    def select(self, scene: Scene) -> None:
        """Chooses where to drive, if that is due."""
        raise NotImplementedError

    def confirm(self, scene: Scene) -> None:
        """Tells the others what this robot explores, when it is another cluster and now and then."""

    def close(self, auction_id: int, bids: Bids, scene: Scene) -> None:
        """The own auction has ended with these bids."""

    def settle(self, robot: str, scene: Scene) -> None:
        """Another robot has told what it explores."""

    def finish(self, scene: Scene) -> None:
        """Tells the others that this robot explores nothing any more."""

    def _drive_to(self, frontier: Frontier, cluster: Optional[int], scene: Scene) -> None:
        x, y, way = scene.views[frontier.number]
        pose = Pose(x, y, math.atan2(frontier.y - y, frontier.x - x))
        self._driver.send(pose, scene.pose, scene.now, way, frontier.number, cluster)

    def _drive_in(self, cluster: Cluster, scene: Scene) -> None:
        """To the nearest frontier (Euclidean) of a cluster, as the paper ranks them."""
        members = [member for member in cluster.members if member.number in scene.ready]
        if members:
            best = min(members, key=lambda m: (distance(scene.place, (m.x, m.y)), m.number))
            self._drive_to(best, cluster.number, scene)

    def _on_its_way(self, scene: Scene) -> bool:
        """The robot drives to a frontier that can still be tried."""
        return self._driver.goal is not None and target_ready(self._driver.goal, scene)

    def _stop_if_over(self, scene: Scene) -> None:
        """Stops if the goal's frontier is no longer one, and no answer of the map is awaited."""
        goal = self._driver.goal
        if goal is not None and goal.frontier is not None and not scene.awaits_map:
            self._driver.drop()


class FrontierSelection(Selection):
    """One frontier, kept until it has vanished or was looked at."""

    def __init__(self, strategy: FrontierStrategy, driver: Driver) -> None:
        super().__init__(driver)
        self._strategy = strategy

    def select(self, scene: Scene) -> None:
        if self._on_its_way(scene):
            return
        order: Sequence[Frontier] = self._strategy.order(scene, scene.frontiers)
        if order:
            self._drive_to(order[0], None, scene)
        else:
            self._stop_if_over(scene)


def target_ready(goal: Goal, scene: Scene) -> bool:
    return goal.frontier is not None and goal.frontier in scene.ready
