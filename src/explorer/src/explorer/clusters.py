"""Clusters of frontier points, and recognising another robot's cluster among the own ones (contract 3.6, 3.7)."""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Dict, List, Optional, Sequence, Set, Tuple

import numpy as np
from scipy.spatial import cKDTree

from explorer._kernels import components, lines_are_clear, near_any
from explorer.frontiers import ForeignFrontiers, Frontier, Key
from explorer.grid import OccupancyMap

# Half edges in metres of the boxes of contract 3.6: clusters closer than the first are one; a point on its own
# joins a cluster nearer than the second.
MERGING_DISTANCE = 0.8
JOINING_DISTANCE = 1.0

# Share of a cluster's elements that must be listed for it to be the listed cluster (contract 3.7).
MATCHING_SHARE = 0.4

# A listed point of another robot stands for an own one within this distance in metres: the two robots thinned
# different maps, so the points differ by up to two thinning distances and the error of the transform.
MATCHING_DISTANCE = 0.6

# Clusters longer than this in metres are cut, so that several robots can share a long frontier.
LONGEST_CLUSTER = 8.0


@dataclass
class Cluster:
    """Frontier points that one robot explores together.

    `members` are own frontiers. `cost` is the path length in metres from the robot to `viewpoint`, infinite while no
    member can be seen from a reachable place; `gain` is the unknown area in square metres around it.
    """

    number: int
    members: List[Frontier]
    cost: float = math.inf
    viewpoint: Optional[Tuple[float, float]] = None
    target: Optional[int] = None
    gain: float = 0.0
    views: Dict[int, Tuple[float, float, float]] = field(default_factory=dict)

    @cached_property
    def points(self) -> np.ndarray:
        """(n, 2) array of the members' positions in metres."""
        return np.array([(member.x, member.y) for member in self.members], dtype=float).reshape(-1, 2)

    @cached_property
    def centre(self) -> Tuple[float, float]:
        x, y = self.points.mean(axis=0)
        return (float(x), float(y))

    @cached_property
    def numbers(self) -> Set[int]:
        return {member.number for member in self.members}

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
    labels = labels.copy()
    following = int(labels.max()) + 1 if len(labels) else 0
    for label in range(following):
        members = np.flatnonzero(labels == label)
        extent = np.ptp(points[members], axis=0)
        axis = int(np.argmax(extent))
        parts = math.ceil(extent[axis] / longest)
        if parts < 2:
            continue
        part = ((points[members, axis] - points[members, axis].min()) / (extent[axis] / parts)).astype(int)
        for number in range(1, parts):
            chosen = members[np.minimum(part, parts - 1) == number]
            labels[chosen] = following
            following += 1
    return np.unique(labels, return_inverse=True)[1] if len(labels) else labels


class ClusterStore:
    """Clusters that keep their numbers from one map to the next: the heir of most members inherits the number."""

    def __init__(self, first_number: int = 0) -> None:
        self._next = first_number
        self.clusters: List[Cluster] = []

    def update(self, frontiers: Sequence[Frontier], occupancy: OccupancyMap) -> List[Cluster]:
        points = np.array([(f.x, f.y) for f in frontiers], dtype=float).reshape(-1, 2)
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
        result = []
        for index, members in enumerate(groups):
            if index not in taken:
                taken[index] = self._next
                self._next += 1
            result.append(Cluster(taken[index], members))
        return sorted(result, key=lambda cluster: cluster.number)


def places_of(listed: Sequence[Key], foreign: ForeignFrontiers, self_name: str) -> np.ndarray:
    """(n, 2) array in metres in the own frame of the listed points of other robots whose place is known."""
    places = foreign.all_in_own_frame([key for key in listed if key[0] != self_name])
    return np.array(places, dtype=float).reshape(-1, 2)


class Listed:
    """Elements that another robot has listed, to be compared with the own clusters."""

    def __init__(self, listed: Sequence[Key], foreign: ForeignFrontiers, self_name: str) -> None:
        self._own = {number for robot, number in listed if robot == self_name}
        self._places = places_of(listed, foreign, self_name)

    def share_of(self, cluster: Cluster) -> float:
        """Share of a cluster's members that are listed: by their own key, or by a listed point of another robot within
        `MATCHING_DISTANCE`."""
        if not cluster.members:
            return 0.0
        found = near_any(cluster.points, self._places, MATCHING_DISTANCE)
        if self._own:
            found |= np.array([member.number in self._own for member in cluster.members], dtype=bool)
        return int(np.count_nonzero(found)) / len(found)


def match(
    clusters: Sequence[Cluster], listed: Sequence[Key], foreign: ForeignFrontiers, self_name: str
) -> Optional[Cluster]:
    """The own cluster that another robot means by a list of elements: the one with the largest share listed, if
    that is above `MATCHING_SHARE`; None if there is none."""
    elements = Listed(listed, foreign, self_name)
    best: Optional[Cluster] = None
    best_share = MATCHING_SHARE
    for cluster in clusters:
        share = elements.share_of(cluster)
        if share > best_share:
            best, best_share = cluster, share
    return best
