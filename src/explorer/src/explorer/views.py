"""From where the robot looks at a frontier, and what it costs to get there."""

import math
from functools import cached_property
from typing import Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from explorer._kernels import nearest_views, search_views
from explorer.clusters import Cluster, View
from explorer.frontiers import Frontier, points_of
from explorer.geometry import turn
from explorer.grid import OccupancyMap, line_is_clear
from explorer.travel import CostField
from mr_grid import GridInfo, Pose
from mr_grid.imaging import nearest_set

# Half edge in metres of the square in which the unknown area around a cluster is counted.
GAIN_REACH = 2.0


class Views:
    """Viewpoints for frontier points, on one map from one place of the robot."""

    def __init__(
        self, occupancy: OccupancyMap, field: CostField, view_distance: float, like: Optional["Views"] = None
    ) -> None:
        """`like`: former views, of which is taken over what is the same; much is, while the robot drives."""
        self._occupancy = occupancy
        self._field = field
        self._view_distance = view_distance
        self._reachable = field.reachable
        comfortable = self._reachable & field.grid.comfortable
        former: Sequence[_NearestCell] = [] if like is None else like._lookups
        self._lookups: List[_NearestCell] = [
            _NearestCell.of(mask, former) for mask in (comfortable, self._reachable) if mask.any()
        ]
        same = like is not None and like._occupancy is occupancy
        self._gains: Dict[Tuple[float, float], float] = like._gains if like is not None and same else {}

    def of(self, points: np.ndarray, groups: Optional[np.ndarray] = None) -> List[Optional[View]]:
        """For each of (n, 2) points in metres the place (x, y) to look from and its cost, all in metres; None where
        no reachable place sees the point. `groups`: (n,) ascending numbers of what is looked at together; how finely
        lines of sight are sampled depends on the farthest point of a group."""
        points = np.asarray(points, dtype=float).reshape(-1, 2)
        groups = np.zeros(len(points), dtype=np.int64) if groups is None else groups
        found = np.full(len(points), -1, dtype=np.int64)
        for lookup in self._lookups:
            missing = np.flatnonzero(found < 0)
            if len(missing):
                found[missing] = self._seen_from_nearest(lookup, points[missing], groups[missing])
        missing = np.flatnonzero(found < 0)
        if self._lookups and len(missing):
            found[missing] = self._searched(points[missing])
        return self._views_at(found)

    def _seen_from_nearest(self, lookup: "_NearestCell", points: np.ndarray, groups: np.ndarray) -> np.ndarray:
        """For (n, 2) points in metres the coarse cell, as a flat index, that is nearest to each, or -1 if the point is
        not in view from there."""
        coarse, fine = self._field.grid.info, self._occupancy.info
        return nearest_views(
            (coarse.resolution, *coarse.origin[:2]),
            lookup.labels,
            lookup.cells,
            (fine.resolution, *fine.origin[:2]),
            self._field.grid.occupied,
            points,
            groups,
            self._view_distance,
        )

    def _views_at(self, cells: np.ndarray) -> List[Optional[View]]:
        """The view for each of (n,) coarse cells, flat indices; None where negative."""
        rows, cols = np.divmod(cells, self._reachable.shape[1])
        places = self._field.grid.info.centres_of(np.column_stack((rows, cols))).tolist()
        costs = self._field.cost.ravel()[cells].tolist()
        return [(x, y, cost) if cell >= 0 else None for (x, y), cost, cell in zip(places, costs, cells.tolist())]

    def assess(self, clusters: Sequence[Cluster], goals: Mapping[int, Frontier]) -> Tuple[Cluster, ...]:
        """The clusters with cost, viewpoint, target, gain and views from those of their members that are `goals`."""
        active = [[member for member in cluster.members if member.number in goals] for cluster in clusters]
        members = [member for chosen in active for member in chosen]
        points = points_of(members)
        views = iter(self.of(points, np.repeat(np.arange(len(active)), [len(chosen) for chosen in active])))
        return tuple(
            self._assessed(cluster, chosen, [next(views) for _ in chosen]) for cluster, chosen in zip(clusters, active)
        )

    def _assessed(self, cluster: Cluster, active: Sequence[Frontier], views: Sequence[Optional[View]]) -> Cluster:
        found = {member.number: view for member, view in zip(active, views) if view is not None}
        gain = self.gain(*cluster.centre)
        if not found:
            return cluster.unseen(gain)
        least = min(view[2] for view in found.values())
        centre = cluster.centre
        # A little more way for a place nearer to the middle: it shows more of the cluster.
        best = min(
            (math.hypot(member.x - centre[0], member.y - centre[1]), member.number)
            for member in active
            if member.number in found and found[member.number][2] <= least + 0.7
        )[1]
        x, y, _ = found[best]
        return cluster.seen(least, (x, y), best, gain, found)

    def gain(self, x: float, y: float) -> float:
        """Unknown area in square metres in the square around a point."""
        if (x, y) not in self._gains:
            self._gains[x, y] = self._unknown_around(x, y)
        return self._gains[x, y]

    def _unknown_around(self, x: float, y: float) -> float:
        info = self._occupancy.info
        row, col = info.cell_of(x, y)
        reach = int(GAIN_REACH / info.resolution)
        top, bottom = (min(max(value, 0), info.height) for value in (row - reach, row + reach + 1))
        left, right = (min(max(value, 0), info.width) for value in (col - reach, col + reach + 1))
        inside = int(np.count_nonzero(self._occupancy.cells[top:bottom, left:right] < 0))
        outside = (2 * reach + 1) ** 2 - (bottom - top) * (right - left)
        return (inside + outside) * info.resolution**2

    def _searched(self, points: np.ndarray) -> np.ndarray:
        """As `_seen_from_nearest`, by trying the reachable cells around each point from near to far."""
        coarse, fine = self._field.grid.info, self._occupancy.info
        return search_views(
            (coarse.resolution, *coarse.origin[:2]),
            self._reachable,
            (fine.resolution, *fine.origin[:2]),
            self._field.grid.occupied,
            points,
            self._view_distance,
        )


def sees(occupied: np.ndarray, info: GridInfo, pose: Pose, field_of_view: float, point: Tuple[float, float]) -> bool:
    """True if a robot there, with a sensor of that field of view (rad), has the point (m) in view, walls considered."""
    x, y = point
    bearing = abs(turn(pose.yaw, math.atan2(y - pose.y, x - pose.x)))
    near = math.hypot(x - pose.x, y - pose.y) < 0.3
    if bearing > field_of_view / 2 and not near:
        return False
    return line_is_clear(occupied, info.cell_of(pose.x, pose.y), info.cell_of(x, y))


class _NearestCell:
    """Tells which cell that is set in a bool array (rows, cols) is nearest; at least one is."""

    def __init__(self, mask: np.ndarray) -> None:
        self._mask = mask

    @classmethod
    def of(cls, mask: np.ndarray, former: Sequence["_NearestCell"]) -> "_NearestCell":
        """One of the former if it is of the same cells."""
        same = [lookup for lookup in former if np.array_equal(lookup._mask, mask)]
        return same[0] if same else cls(mask)

    @cached_property
    def cells(self) -> np.ndarray:
        """The cells that are set, as flat indices in the order of rows: int64 (n,)."""
        return np.flatnonzero(self._mask)

    @cached_property
    def labels(self) -> np.ndarray:
        """For each cell the number of the nearest one that is set, from 1 on in the order of `cells`: int32."""
        return nearest_set(self._mask)
