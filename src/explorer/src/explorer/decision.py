"""A decision with all that it depended on, so that it can be recorded, replayed and drawn."""

from dataclasses import dataclass, field
from typing import Any, Callable, Dict, Mapping, Optional, Type

import numpy as np

from explorer.scene import Scene
from explorer.strategies.strategy import Bids, ClusterStrategy, FrontierStrategy, Strategy


@dataclass(frozen=True)
class Decision:
    """`choice`: number of the cluster, or of the frontier point for a strategy without clusters; None: none was for
    this robot. `random`: state of the strategy's generator before. `reasons`: {frontier number: why it is no goal}."""

    robot: str
    strategy: str
    scene: Scene
    bids: Bids
    choice: Optional[int]
    random: Mapping[str, Any] = field(default_factory=dict)
    reasons: Mapping[int, str] = field(default_factory=dict)


Tell = Callable[[Scene, Bids, Optional[int], Mapping[str, Any]], None]
"""Takes scene, bids, choice and the state of the generator before, each time a strategy has decided."""


def choice_of(strategy: Strategy, scene: Scene, bids: Bids) -> Optional[int]:
    """What a strategy chooses: number of a cluster or of a frontier point, None if there is none for this robot."""
    if isinstance(strategy, FrontierStrategy):
        order = strategy.order(scene, scene.frontiers)
        return order[0].number if order else None
    assert isinstance(strategy, ClusterStrategy)
    cluster = strategy.choose(scene, bids)
    return None if cluster is None else cluster.number


def replayed(decision: Decision, kind: Type[Strategy]) -> Optional[int]:
    """What a strategy chooses there; the one that decided chooses the same again."""
    random = np.random.default_rng(0)
    if decision.random:
        random.bit_generator.state = dict(decision.random)
    return choice_of(kind(random), decision.scene, decision.bids)


def telling(kind: Type[Strategy], random: np.random.Generator, tell: Tell) -> Strategy:
    """A strategy of that kind that tells of each decision."""
    base: Type[_Telling] = _TellingOrder if issubclass(kind, FrontierStrategy) else _TellingChoice
    namespace: Dict[str, Any] = {"__module__": kind.__module__}
    strategy: _Telling = type(kind.__name__, (base, kind), namespace)(random)
    strategy.tell = tell
    return strategy


class _Telling(Strategy):
    tell: Tell


class _TellingChoice(_Telling, ClusterStrategy):
    def choose(self, scene: Scene, bids: Bids) -> Any:
        before = self._random.bit_generator.state
        cluster = super().choose(scene, bids)
        self.tell(scene, bids, None if cluster is None else cluster.number, before)
        return cluster


class _TellingOrder(_Telling, FrontierStrategy):
    def order(self, scene: Scene, frontiers: Any) -> Any:
        before = self._random.bit_generator.state
        order = super().order(scene, frontiers)
        self.tell(scene, {}, order[0].number if order else None, before)
        return order
