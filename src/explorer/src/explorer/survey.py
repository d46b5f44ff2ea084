"""What one map alone shows: its frontiers, their clusters, and why some are no goals."""

from dataclasses import dataclass
from typing import Dict, List, Optional, Tuple

import numpy as np

from explorer._kernels import distances_to, pooled_maximum
from explorer.clusters import Cluster
from explorer.errors import MapError
from explorer.frontier_map import frontier_cells
from explorer.geometry import Position
from explorer.grid import OccupancyMap
from explorer.leftovers import reasons
from explorer.options import Options
from explorer.perception import Perception
from explorer.senses import Senses
from explorer.travel import SNAP_DISTANCE
from explorer.verdicts import Verdicts
from explorer.ways import Ways
from mr_grid import Pose
from mr_grid.imaging import part_labels, parts_of


@dataclass(frozen=True)
class Stretch:
    """Connected frontier cells: `cells` are their (n, 2) centres in metres, `place` that of the middle one, `length` in
    metres. `clusters`: numbers of those that its points are in. `reason`: why it is no goal, empty if it is one."""

    place: Position
    length: float
    cells: np.ndarray
    clusters: Tuple[int, ...]
    reason: str


@dataclass(frozen=True)
class Survey:
    """As seen by a robot at `start` (m). `reasons`: {frontier number: why it is no goal}."""

    occupancy: OccupancyMap
    start: Position
    stretches: Tuple[Stretch, ...]
    clusters: Tuple[Cluster, ...]
    reasons: Dict[int, str]


def survey(occupancy: OccupancyMap, options: Options, start: Optional[Position] = None) -> Survey:
    """Without a `start` the robot is in the largest space. Raises `MapError` if it cannot be where it is said to be."""
    ways = Ways(occupancy, options.inflation_radius, [], options.largest_robot_radius)
    place = _in_largest_space(ways) if start is None else start
    if ways.grid.nearest(ways.grid.traversable, *place, SNAP_DISTANCE) is None:
        raise MapError(f"no robot of radius {options.inflation_radius:g} m can be at ({place[0]:g}, {place[1]:g})")
    senses, verdicts = Senses(None), Verdicts()
    senses.take_map(occupancy, 0.0)
    senses.take_pose(Pose(*place, 0.0), 0.0)
    perception = Perception(options, senses)
    perception.take_map()
    perception.update(verdicts, [], 0, 0.0)
    why = reasons(perception.clusters, perception.worth)
    stretches = _stretches(occupancy, options.minimal_frontier_length, perception.clusters, why)
    return Survey(occupancy, place, tuple(stretches), perception.clusters, why)


def _in_largest_space(ways: Ways) -> Position:
    """A place in the largest connected space, as far from its walls as possible."""
    grid = ways.grid
    parts = parts_of(grid.traversable)
    if len(parts.areas) < 2:
        raise MapError("there is no place for a robot on this map")
    largest = parts.labels == 1 + int(np.argmax(parts.areas[1:]))
    layers, clearance = grid.ground.layers, np.full(grid.occupied.shape, np.inf, dtype=np.float32)
    if layers.occupied.any():
        clearance = distances_to(layers.occupied, grid.ground.occupancy.info.resolution)
    clearance = pooled_maximum(clearance, layers.allowed, grid.factor)
    row, col = divmod(int(np.argmax(np.where(largest, clearance, -1.0))), largest.shape[1])
    return grid.info.centre_of(row, col)


def _stretches(
    occupancy: OccupancyMap, shortest: float, clusters: Tuple[Cluster, ...], why: Dict[int, str]
) -> List[Stretch]:
    """All connected frontiers, the longest first; those that are too short are noise."""
    long_enough = frontier_cells(occupancy, shortest)
    count, labels = part_labels(frontier_cells(occupancy, 0.0))
    points = _points_by_label(occupancy, labels, clusters)
    found = []
    for label in range(1, count):
        cells = np.argwhere(labels == label)
        reason = "" if long_enough[tuple(cells[0])] else f"noise: shorter than {shortest:g} m"
        members = points.get(label, [])
        told = [why.get(number, "") for number, _ in members]
        if not reason and told and all(told):
            reason = max(sorted(set(told)), key=told.count)
        centres = occupancy.info.centres_of(cells)
        middle = centres[int(np.argmin(np.hypot(*(centres - centres.mean(axis=0)).T)))]
        numbers = tuple(sorted({cluster for _, cluster in members}))
        length = len(cells) * occupancy.info.resolution
        found.append(Stretch((float(middle[0]), float(middle[1])), length, centres, numbers, reason))
    return sorted(found, key=lambda stretch: (-stretch.length, stretch.place))


def _points_by_label(
    occupancy: OccupancyMap, labels: np.ndarray, clusters: Tuple[Cluster, ...]
) -> Dict[int, List[Tuple[int, int]]]:
    """{label: numbers of the frontier point and its cluster}; labels (rows, cols) of the map's cells."""
    found: Dict[int, List[Tuple[int, int]]] = {}
    for cluster in clusters:
        for member in cluster.members:
            label = int(labels[occupancy.info.cell_of(member.x, member.y)])
            found.setdefault(label, []).append((member.number, cluster.number))
    return found
