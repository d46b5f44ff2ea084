"""Recognising among the own clusters what another robot means by a list of elements (contract 3.6, 3.7)."""

from dataclasses import dataclass
from itertools import chain
from typing import FrozenSet, List, Optional, Sequence

import numpy as np

from explorer._kernels import near_any
from explorer.clusters import Cluster
from explorer.foreign import ForeignFrontiers, Key

# Share of a cluster's elements that must be listed for it to be the listed cluster (contract 3.7).
MATCHING_SHARE = 0.4

# A listed point of another robot stands for an own one within this distance in metres: the two robots thinned
# different maps, so the points differ by up to two thinning distances and the error of the transform.
MATCHING_DISTANCE = 0.6


@dataclass(frozen=True)
class Listed:
    """Elements that another robot has listed, as this robot sees them: numbers of `own` points, and `places` of other
    points as an (n, 2) array in metres in the own frame."""

    own: FrozenSet[int]
    places: np.ndarray

    def share_of(self, cluster: Cluster) -> float:
        return Recognition([cluster]).shares(self)[0]


class Recognition:
    """Of these clusters, the own ones, in what other robots list."""

    def __init__(self, clusters: Sequence[Cluster]) -> None:
        self._clusters = clusters
        self._points = np.concatenate([np.empty((0, 2)), *(cluster.points for cluster in clusters)])
        self._sizes = [len(cluster.members) for cluster in clusters]
        self._until = np.cumsum([0, *self._sizes])

    def shares(self, elements: Listed) -> List[float]:
        """For each cluster the share of its members that are listed: by their own key, or by a listed point of another
        robot within `MATCHING_DISTANCE`."""
        found = near_any(self._points, elements.places, MATCHING_DISTANCE)
        if elements.own:
            numbers = (member.number for cluster in self._clusters for member in cluster.members)
            found |= np.fromiter((number in elements.own for number in numbers), dtype=bool, count=len(found))
        elif not found.any():
            return [0.0] * len(self._sizes)
        counts = np.diff(np.concatenate([[0], np.cumsum(found)])[self._until])
        return [count / size if size else 0.0 for count, size in zip(counts.tolist(), self._sizes)]

    def match(self, elements: Listed) -> Optional[Cluster]:
        """The cluster that is meant: the one with the largest share listed, if that is above `MATCHING_SHARE`; None if
        there is none."""
        best: Optional[Cluster] = None
        best_share = MATCHING_SHARE
        for cluster, share in zip(self._clusters, self.shares(elements)):
            if share > best_share:
                best, best_share = cluster, share
        return best


def listed(keys: Sequence[Key], foreign: ForeignFrontiers, own_name: str) -> Listed:
    """Points of other robots count where their place is known."""
    places = foreign.in_own_frame([key for key in keys if key[0] != own_name])
    own = frozenset(number for robot, number in keys if robot == own_name)
    numbers = np.fromiter(chain.from_iterable(places), dtype=float, count=2 * len(places))
    return Listed(own, numbers.reshape(-1, 2))
