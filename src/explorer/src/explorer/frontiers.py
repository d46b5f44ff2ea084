"""Frontiers: free cells next to unknown ones (Yamauchi 1997), thinned to points that keep their identity."""

from dataclasses import dataclass, field
from typing import Collection, Dict, List, Tuple

import numpy as np

from explorer import _kernels
from explorer.grid import OccupancyMap

# Half edge in metres of the box in which two frontier points count as one (contract 3.4).
THINNING_DISTANCE = 0.2

# Points beyond this number are not stored: bounds messages and computing time on a noisy map.
MAXIMUM_FRONTIERS = 4000


@dataclass(frozen=True)
class Frontier:
    """A frontier point of this robot, in metres in its map frame."""

    number: int
    x: float
    y: float


def points_of(frontiers: Collection[Frontier]) -> np.ndarray:
    """(n, 2) array in metres."""
    # Column by column: an array of a thousand pairs takes several times as long.
    columns = np.array([[f.x for f in frontiers], [f.y for f in frontiers]], dtype=float)
    return np.ascontiguousarray(columns.T)


def thin(points: np.ndarray, distance: float = THINNING_DISTANCE) -> np.ndarray:
    """Subset of an (n, 2) array of points in metres: each point left out has one of the subset within the box of
    half edge `distance`, no two of the subset lie in each other's box. Deterministic, first come first kept."""
    points = np.asarray(points, dtype=float).reshape(-1, 2)
    return points[_kernels.thin(points, distance)]


@dataclass
class FrontierStore:
    """The frontier points of this robot. A point keeps its number as long as a frontier cell is in its box."""

    first_number: int = 0
    frontiers: Dict[int, Frontier] = field(default_factory=dict)
    _count: int = 0

    def update(self, occupancy: OccupancyMap, cells: np.ndarray) -> Tuple[List[Frontier], List[Frontier]]:
        """Takes the frontier cells of a new map (bool array of the map's shape); returns points new and gone."""
        stored = self.ordered()
        own = occupancy.info.cells_of(points_of(stored))
        stays = occupancy.info.inside(own)
        stays[stays] = _kernels.any_in_box(cells, own[stays], _reach(occupancy))
        gone = [frontier for frontier, there in zip(stored, stays.tolist()) if not there]
        for frontier in gone:
            del self.frontiers[frontier.number]
        return self._add(_uncovered(occupancy, cells, own[stays])), gone

    def clear(self) -> None:
        """Forgets all points; new points get new numbers."""
        self.frontiers.clear()

    def ordered(self) -> List[Frontier]:
        """By number: so they are stored."""
        return list(self.frontiers.values())

    def _add(self, points: np.ndarray) -> List[Frontier]:
        """Takes (n, 2) points in metres; those beyond `MAXIMUM_FRONTIERS` are not stored."""
        new = []
        for x, y in points[: max(0, MAXIMUM_FRONTIERS - len(self.frontiers))].tolist():
            frontier = Frontier(self.first_number + self._count, x, y)
            self._count += 1
            self.frontiers[frontier.number] = frontier
            new.append(frontier)
        return new


def _uncovered(occupancy: OccupancyMap, cells: np.ndarray, stored: np.ndarray) -> np.ndarray:
    """(n, 2) points in metres for the frontier cells that are in no box of the cells (m, 2) of stored points."""
    covering = np.zeros(cells.shape, dtype=bool)
    covering[stored[:, 0], stored[:, 1]] = True
    # Several times faster than looking for them in two dimensions.
    frontier_cells = np.column_stack(np.divmod(np.flatnonzero(cells), cells.shape[1]))
    covered = _kernels.any_in_box(covering, frontier_cells, _reach(occupancy))
    return thin(occupancy.info.centres_of(frontier_cells[~covered]))


def _reach(occupancy: OccupancyMap) -> int:
    """Half edge in cells of the box in which two frontier points count as one."""
    return max(1, int(THINNING_DISTANCE / occupancy.info.resolution))
