"""The cluster that this robot explores, and what the others were told of it."""

import math
from typing import Optional, Tuple

from explorer.auction import elements_of
from explorer.clusters import Cluster
from explorer.foreign import Key


class OwnClaim:
    """`number`: of the own cluster. `told`: its elements when they were last told, at `told_at` in seconds."""

    def __init__(self, name: str) -> None:
        self._name = name
        self.number: Optional[int] = None
        self.told: Tuple[Key, ...] = ()
        self.told_at = -math.inf
        self._idle_since: Optional[float] = None

    def take(self, cluster: Optional[Cluster], now: float) -> None:
        """Explores that cluster; None: the robot was left empty-handed."""
        self.number = None if cluster is None else cluster.number
        if cluster is not None:
            self._idle_since = None
        elif self._idle_since is None:
            self._idle_since = now

    def release(self) -> None:
        """Explores no cluster for now."""
        self.number = None

    def lose(self) -> None:
        """Another robot has the better claim."""
        self.number, self.told = None, ()

    def idle(self, now: float) -> float:
        """For how long in s the robot has been left empty-handed."""
        return 0.0 if self._idle_since is None else now - self._idle_since

    def tell(self, cluster: Optional[Cluster], now: float) -> Tuple[Key, ...]:
        """The elements to be told of the own cluster, which count as told; none without one."""
        self.told, self.told_at = self._elements(cluster), now
        return self.told

    def changed(self, cluster: Optional[Cluster]) -> bool:
        """True if what was told is no longer the own cluster."""
        elements = set(self._elements(cluster))
        kept = len(elements & set(self.told))
        return kept * 2 < len(elements) or (not elements and bool(self.told))

    def _elements(self, cluster: Optional[Cluster]) -> Tuple[Key, ...]:
        return () if cluster is None else elements_of(cluster, self._name)
