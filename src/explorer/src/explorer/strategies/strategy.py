"""What a strategy is: what it goes for, what it bids, what it chooses. A new one is a subclass in a file of its own."""

from abc import ABC
from enum import Enum
from typing import ClassVar, Dict, List, Mapping, Optional, Sequence, Type

import numpy as np

from explorer.assignment import squared_euclidean
from explorer.clusters import Cluster
from explorer.frontiers import Frontier
from explorer.geometry import Position, distance
from explorer.messages import PAPER_UNIT
from explorer.scene import Scene

Bids = Mapping[str, Mapping[int, float]]
"""{robot: {number of an own cluster: bid}}; a robot that has answered without a bid for a cluster does not know it."""


class Allocation(Enum):
    """How robots agree on who goes where."""

    ALONE = "each robot for itself"
    NEGOTIATED = "choices are announced"
    AUCTIONED = "auctions of clusters, held when a robot has none"
    CONTINUOUS = "auctions of clusters, held anew while driving"


class Strategy(ABC):
    """Decides from a `Scene` alone. `random` is of the robot; other state there is none but what saves time."""

    number: ClassVar[int]  # value of the parameter `frontier_selection`
    name: ClassVar[str]
    title: ClassVar[str]  # one line for people
    allocation: ClassVar[Allocation]
    unit: ClassVar[int] = PAPER_UNIT  # of its bids: the number of the first strategy that counts so

    def __init__(self, random: np.random.Generator) -> None:
        self._random = random

    def bid(self, scene: Scene, cluster: Cluster) -> float:
        """What the cluster costs this robot, not negative: integer part of the squared Euclidean distance, as in the
        paper."""
        return self.estimate(scene, scene.place, cluster)

    def estimate(self, scene: Scene, position: Position, cluster: Cluster) -> float:
        """The bid of a robot at a position in metres that has told none."""
        return squared_euclidean(position, nearest_member(cluster, position))


class FrontierStrategy(Strategy):
    """Goes for one frontier point, and keeps to it until it has vanished or was looked at."""

    allocation = Allocation.ALONE

    def order(self, scene: Scene, frontiers: Sequence[Frontier]) -> List[Frontier]:
        """The points, best first; they come by number."""
        raise NotImplementedError


class ClusterStrategy(Strategy):
    """Goes for a cluster."""

    def choose(self, scene: Scene, bids: Bids) -> Optional[Cluster]:
        """One of the open clusters, or None if none is for this robot."""
        raise NotImplementedError


def nearest_member(cluster: Cluster, place: Position) -> Position:
    """Position of the cluster's member with a viewpoint that is nearest to a place."""
    members = [m for m in cluster.members if m.number in cluster.views] or cluster.members
    best = min(members, key=lambda m: (distance(place, (m.x, m.y)), m.number))
    return (best.x, best.y)


REGISTRY: Dict[int, Type[Strategy]] = {}


def registered(strategy: Type[Strategy]) -> Type[Strategy]:
    """Class decorator: makes the strategy known by its number and its name."""
    if strategy.number in REGISTRY or any(strategy.name == other.name for other in REGISTRY.values()):
        raise ValueError(f"strategy {strategy.number} ({strategy.name}) is registered twice")
    REGISTRY[strategy.number] = strategy
    return strategy
