"""Clusters: frontier points that one robot explores together (contract 3.6)."""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Dict, FrozenSet, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from explorer._kernels import components, lines_are_clear
from explorer.frontiers import Frontier, points_of
from explorer.grid import OccupancyMap

# Half edges in metres of the boxes of contract 3.6: clusters closer than the first are one; a point on its own
# joins a cluster nearer than the second.
MERGING_DISTANCE = 0.8
JOINING_DISTANCE = 1.0

# Clusters longer than this in metres are cut, so that several robots can share a long frontier.
LONGEST_CLUSTER = 8.0


View = Tuple[float, float, float]
"""Where to look from, x and y, and the path length to there, all in metres."""


@dataclass(frozen=True)
class Cluster:
    """Frontier points that one robot explores together.

    `members` are own frontiers, `views` {number: view} of those that are worth a visit and in sight of a reachable
    place. `cost` is the path length in metres from the robot to the nearest of these, infinite without any. The robot
    drives to `viewpoint` (metres) to look at the member `target`. `gain` is the unknown area in square metres around.
    """

    number: int
    members: Tuple[Frontier, ...]
    cost: float = math.inf
    viewpoint: Optional[Tuple[float, float]] = None
    target: Optional[int] = None
    gain: float = 0.0
    views: Mapping[int, View] = field(default_factory=dict)

    def seen(
        self,
        cost: float,
        viewpoint: Optional[Tuple[float, float]],
        target: Optional[int],
        gain: float,
        views: Mapping[int, View],
    ) -> "Cluster":
        """The same members with other views."""
        cluster = Cluster(self.number, self.members, cost, viewpoint, target, gain, views)
        # What depends on the members alone is not computed again.
        kept = {name: self.__dict__[name] for name in ("points", "centre", "numbers") if name in self.__dict__}
        cluster.__dict__.update(kept)
        return cluster

    def unseen(self, gain: float) -> "Cluster":
        """The same members without views."""
        return self.seen(math.inf, None, None, gain, {})

    @cached_property
    def points(self) -> np.ndarray:
        """(n, 2) array of the members' positions in metres."""
        return points_of(self.members)

    @cached_property
    def centre(self) -> Tuple[float, float]:
        x, y = self.points.mean(axis=0)
        return (float(x), float(y))

    @cached_property
    def numbers(self) -> FrozenSet[int]:
        return frozenset(member.number for member in self.members)

    @property
    def place(self) -> Tuple[float, float]:
        """Where to go in metres: the viewpoint, or the middle while there is none."""
        return self.viewpoint if self.viewpoint is not None else self.centre

    @property
    def reachable(self) -> bool:
        return math.isfinite(self.cost)


def group(points: np.ndarray, occupancy: Optional[OccupancyMap] = None) -> np.ndarray:
    """(n,) int array of cluster labels 0.. for (n, 2) points in metres.

    Points in each other's box of `MERGING_DISTANCE` are together, then single points join the nearest cluster in
    their box of `JOINING_DISTANCE`. With a map, a wall between two points separates them: what lies in two rooms is
    not explored in one visit.
    """
    points = np.asarray(points, dtype=float).reshape(-1, 2)
    if len(points) == 0:
        return np.zeros(0, dtype=np.int64)
    from scipy.spatial import cKDTree  # slow to import, and many a program only names strategies

    pairs = cKDTree(points).query_pairs(JOINING_DISTANCE, p=math.inf, output_type="ndarray")
    if len(pairs) and occupancy is not None:
        cells = occupancy.info.cells_of(points)
        pairs = pairs[lines_are_clear(occupancy.occupied, cells[pairs[:, 0]], cells[pairs[:, 1]])]
    gaps = np.abs(points[pairs[:, 0]] - points[pairs[:, 1]]).max(axis=1) if len(pairs) else np.zeros(0)
    close = pairs[gaps < MERGING_DISTANCE] if len(pairs) else pairs
    labels = components(len(points), close)
    return _join_singles(labels, pairs, gaps)


def _join_singles(labels: np.ndarray, pairs: np.ndarray, gaps: np.ndarray) -> np.ndarray:
    sizes = np.bincount(labels)
    first, second = labels[pairs[:, 0]], labels[pairs[:, 1]]
    # What is together stays so, and no cluster becomes a single point.
    relevant = (first != second) & ((sizes[first] == 1) | (sizes[second] == 1)) & (gaps < JOINING_DISTANCE)
    pairs, gaps = pairs[relevant], gaps[relevant]
    for a, b in pairs[np.argsort(gaps, kind="stable")].tolist():
        if labels[a] == labels[b]:
            continue
        if sizes[labels[a]] == 1:
            a, b = b, a
        if sizes[labels[b]] == 1:
            sizes[labels[a]] += 1
            sizes[labels[b]] = 0
            labels[b] = labels[a]
    return np.unique(labels, return_inverse=True)[1]


def split_long(points: np.ndarray, labels: np.ndarray, longest: float = LONGEST_CLUSTER) -> np.ndarray:
    """Labels of `group` with clusters whose bounding box is longer than `longest` metres cut into equal parts."""
    if len(labels) == 0:
        return labels
    labels = labels.copy()
    following = int(labels.max()) + 1
    order = np.argsort(labels, kind="stable")
    first = np.searchsorted(labels[order], np.arange(following))
    extents = np.maximum.reduceat(points[order], first) - np.minimum.reduceat(points[order], first)
    for label in np.flatnonzero(extents.max(axis=1) > longest).tolist():
        members = np.flatnonzero(labels == label)
        extent = extents[label]
        axis = int(np.argmax(extent))
        parts = math.ceil(extent[axis] / longest)
        part = ((points[members, axis] - points[members, axis].min()) / (extent[axis] / parts)).astype(int)
        for number in range(1, parts):
            chosen = members[np.minimum(part, parts - 1) == number]
            labels[chosen] = following
            following += 1
    return np.unique(labels, return_inverse=True)[1]


class ClusterStore:
    """Clusters that keep their numbers from one map to the next: the heir of most members inherits the number."""

    def __init__(self, first_number: int = 0) -> None:
        self._next = first_number
        self.clusters: List[Cluster] = []  # without views

    def update(self, frontiers: Sequence[Frontier], occupancy: OccupancyMap) -> List[Cluster]:
        points = points_of(frontiers)
        labels = split_long(points, group(points, occupancy))
        groups: List[List[Frontier]] = [[] for _ in range(int(labels.max()) + 1 if len(labels) else 0)]
        for frontier, label in zip(frontiers, labels):
            groups[label].append(frontier)
        self.clusters = self._with_numbers(groups)
        return self.clusters

    def _with_numbers(self, groups: List[List[Frontier]]) -> List[Cluster]:
        former = {number: cluster.number for cluster in self.clusters for number in cluster.numbers}
        claims = []
        for index, members in enumerate(groups):
            votes: Dict[int, int] = {}
            for member in members:
                if member.number in former:
                    votes[former[member.number]] = votes.get(former[member.number], 0) + 1
            claims += [(-count, number, index) for number, count in votes.items()]
        taken: Dict[int, int] = {}
        for _, number, index in sorted(claims):
            if index not in taken and number not in taken.values():
                taken[index] = number
        result, former_clusters = [], {cluster.number: cluster for cluster in self.clusters}
        for index, members in enumerate(groups):
            if index not in taken:
                taken[index] = self._next
                self._next += 1
            cluster = Cluster(taken[index], tuple(members))
            former_cluster = former_clusters.get(cluster.number, cluster)
            # What is known of the same cluster is not computed again.
            result.append(former_cluster if former_cluster.members == cluster.members else cluster)
        return sorted(result, key=lambda cluster: cluster.number)
