"""What the figures of a mission mean, as functions on arrays. Definitions: docs/measures.md.

A map is placed in the world by the robot's true start pose, because a local map has its origin where the robot began.
All positions in metres, angles in radians, times in simulated seconds.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Optional

import cv2
import numpy as np
from scipy import ndimage

from mr_grid import OccupancyGrid, Pose
from mr_sim import _world
from mr_sim.raster import Grid
from mr_sim.world import World
from mr_sim.world_model import Polygon

FREE_BELOW = 50  # an occupancy value from 0 to this (exclusive) is explored free space
OCCUPIED_FROM = 65  # an occupancy value from this on is a wall
WALL_MARGIN = 0.1  # m: free cells nearer to a wall than this are no reference cells
WALL_TOLERANCE = 0.15  # m: an occupied cell farther from a true wall than this is a wrong wall
MOVING_SPEED, MOVING_TURN = 0.05, 0.1  # m/s, rad/s: above either a robot is moving

_REFERENCE_RESOLUTION = 0.05  # m, lattice of the reference cells
_HEADINGS = 16  # headings in which the footprint is tried
_VIEWPOINT_SPACING = 0.3  # m between the poses looked from
_BEAMS = 720
_SURROUND = 1.0  # m around the walls in which the distance to them is known


class KnowableArea(NamedTuple):
    """What robots can get to know of a world. `viewpoints` (N, 2): positions they reach, m, thinned out; `cells`: bool
    (rows, columns), the reference cells, 0.05 m each, cell (0, 0) at the lower left corner of the walls."""

    viewpoints: np.ndarray
    cells: np.ndarray


class Truth:
    """What maps are compared with: the true walls and the reference free cells of a world."""

    def __init__(
        self,
        walls: Grid,
        starts: Sequence[Pose],
        footprint: Sequence[Polygon],
        range_max: float,
        known: Optional[KnowableArea] = None,
    ) -> None:
        """`starts`: world poses from which the footprint drives; `range_max`: of the laser. Takes seconds, unless what
        can be known from there has been computed before (`known`)."""
        pad = math.ceil(_SURROUND / walls.resolution)
        cells = np.pad(walls.cells, pad)
        self._resolution = walls.resolution
        self._origin = np.asarray(walls.origin) - pad * walls.resolution
        # From the centre of a cell to the face of the nearest wall.
        self._distance = ndimage.distance_transform_edt(cells == 0) * walls.resolution - walls.resolution / 2.0
        if known is None:
            self.viewpoints = self._viewpoints(cells, starts, footprint)
            known = KnowableArea(self.viewpoints, self._reference_cells(walls, range_max))
        self.viewpoints, self.knowable = known.viewpoints, known.cells
        self.reference = _centres_of(known.cells, walls)
        self.cell_area = _REFERENCE_RESOLUTION**2  # m^2

    @classmethod
    def of_world(cls, world: World, known: Optional[KnowableArea] = None) -> "Truth":
        """Truth for the robots of a world; the footprint and laser are those of the first robot."""
        robot = world.robots[0]
        range_max = max((ranger.range_max for ranger in robot.rangers), default=0.0)
        return cls(world.visible, [r.start for r in world.robots], robot.footprint, range_max, known)

    def wall_distance(self, points: np.ndarray) -> np.ndarray:
        """Distance (N,) from points (N, 2) to the nearest true wall, 0 inside it, infinite far outside the world."""
        index = np.floor((points - self._origin) / self._resolution).astype(np.int64)
        inside = ((index >= 0) & (index < self._distance.shape[::-1])).all(axis=1)
        distance = np.full(len(points), np.inf)
        distance[inside] = np.maximum(self._distance[index[inside, 1], index[inside, 0]], 0.0)
        return distance

    def _viewpoints(self, cells: np.ndarray, starts: Sequence[Pose], footprint: Sequence[Polygon]) -> np.ndarray:
        """Positions (N, 2), thinned out, that the footprint reaches from the starts in one of its headings.

        Reachability is by connection of the free poses (x, y, heading), without regard to how the robot steers.
        """
        free = np.stack([self._fits(cells, footprint, 2.0 * math.pi * k / _HEADINGS) for k in range(_HEADINGS)])
        around = np.concatenate([free, free[:1]])  # heading 2 pi is heading 0 again
        labels, _ = ndimage.label(around)
        self._join_seam(labels)
        reached: set = set()
        for start in starts:
            column, row = np.floor((np.asarray(start[:2]) - self._origin) / self._resolution).astype(int)
            # Any heading: the kernels are coarser than a start pose that just fits.
            reached.update(int(label) for label in labels[:, row, column])
        reached.discard(0)
        is_reached = np.zeros(int(labels.max()) + 1, dtype=bool)
        is_reached[list(reached)] = True
        reachable = is_reached[labels[:_HEADINGS]].any(axis=0)
        stride = max(1, round(_VIEWPOINT_SPACING / self._resolution))
        return (np.argwhere(reachable[::stride, ::stride])[:, ::-1] * stride + 0.5) * self._resolution + self._origin

    def _fits(self, cells: np.ndarray, footprint: Sequence[Polygon], heading: float) -> np.ndarray:
        """Cells, bool (rows, columns), at whose centre the footprint touches no wall in this heading."""
        turned = [np.array([Pose(0.0, 0.0, heading).apply_point(*p) for p in polygon]) for polygon in footprint]
        reach = math.ceil(max(np.abs(corners).max() for corners in turned) / self._resolution) + 1
        kernel = np.zeros((2 * reach + 1, 2 * reach + 1), dtype=np.uint8)
        for corners in turned:
            cv2.fillPoly(kernel, [np.round(corners / self._resolution + reach).astype(np.int32)], 1)
        # A correlation with the footprint: true where wall and footprint share a cell.
        return cv2.dilate(cells, kernel[::-1, ::-1]) == 0

    @staticmethod
    def _join_seam(labels: np.ndarray) -> None:
        """Give regions that are one across the seam of the heading the same label."""
        first, last = labels[0], labels[-1]
        for label in np.unique(last[last > 0]):
            for other in np.unique(first[(last == label) & (first > 0)]):
                if other != label:
                    labels[labels == other] = label

    def _reference_cells(self, walls: Grid, range_max: float) -> np.ndarray:
        """The free cells, bool (rows, columns), in view from a viewpoint, without those beside a wall."""
        rows, columns = (math.ceil(n * walls.resolution / _REFERENCE_RESOLUTION - 1e-6) for n in walls.cells.shape)
        seen = np.zeros((rows, columns), dtype=np.uint8)
        raster = _world.Raster(walls.cells, walls.resolution, walls.origin)
        angles = np.arange(_BEAMS) * (2.0 * math.pi / _BEAMS)
        beams = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        for point in self.viewpoints:
            ends = point + beams * raster.cast((point[0], point[1]), angles, range_max)[:, None]
            pixels = np.floor((ends - walls.origin) / _REFERENCE_RESOLUTION).astype(np.int32)
            cv2.fillPoly(seen, [pixels], 1)
        found = seen > 0
        found[found] = self.wall_distance(_centres_of(found, walls)) >= WALL_MARGIN
        return found


def _centres_of(cells: np.ndarray, walls: Grid) -> np.ndarray:
    """Centres (N, 2) in the world of the cells of the lattice of reference cells, bool (rows, columns)."""
    centres: np.ndarray = (np.argwhere(cells)[:, ::-1] + 0.5) * _REFERENCE_RESOLUTION + walls.origin
    return centres


def coverage(truth: Truth, occupancy: OccupancyGrid, start: Pose) -> float:
    """Share of the reference free cells that the map knows; `start`: the robot's true start pose."""
    if len(truth.reference) == 0:
        raise ValueError("the world has no reference cells: no robot can move in it")
    values = occupancy.values_at(start.apply_inverse(truth.reference))
    return float((values >= 0).mean())


def wrong_walls(truth: Truth, occupancy: OccupancyGrid, start: Pose) -> float:
    """Share of the map's occupied cells that are no true wall; 0 for a map without occupied cells."""
    occupied = occupancy.info.centres_of(np.argwhere(occupancy.cells >= OCCUPIED_FROM))
    if len(occupied) == 0:
        return 0.0
    return float((truth.wall_distance(start.apply(occupied)) > WALL_TOLERANCE).mean())


def explored_free_cells(occupancy: OccupancyGrid) -> int:
    """P_n of the map error."""
    return int(((occupancy.cells >= 0) & (occupancy.cells < FREE_BELOW)).sum())


def map_error(explored_free_cells: int, reference: float) -> float:
    """e in percent (paper VII-A): explored free cells against P_ref, signed."""
    if not reference > 0.0:
        raise ValueError(f"the reference must be positive, not {reference:g}")
    return (explored_free_cells / reference - 1.0) * 100.0


def overlap_between_robots(explored: Sequence[np.ndarray]) -> float:
    """Sum of what each robot explored itself over their union, minus 1; `explored`: bool masks of one shape."""
    union = np.logical_or.reduce(list(explored)).sum()
    return float(sum(int(mask.sum()) for mask in explored) / union - 1.0) if union else 0.0


def distance_driven(records: np.ndarray) -> float:
    """Metres driven according to a robot's truth trace (`trace.Trace.robots`)."""
    return float(np.hypot(np.diff(records["x"]), np.diff(records["y"])).sum())


def moving_share(records: np.ndarray, begin: float, end: float) -> float:
    """Share of the time with a task that the robot moves: from `begin`, the start of the mission, to `end`, when this
    robot has finished its exploration."""
    task = records[(records["time"] > begin) & (records["time"] <= end)]
    if len(task) == 0:
        return 0.0
    return float(((np.abs(task["v"]) > MOVING_SPEED) | (np.abs(task["w"]) > MOVING_TURN)).mean())


@dataclass(frozen=True)
class Collisions:
    """Contacts of a robot: a run of steps in which it was blocked by the same kind of thing is one contact."""

    with_walls: int
    with_robots: int
    times: tuple[float, ...]  # when each began

    @property
    def total(self) -> int:
        return self.with_walls + self.with_robots


def collisions(records: np.ndarray) -> Collisions:
    """Collisions of a robot according to its truth trace.

    The simulator stops a robot before its footprint would overlap something, so each such stop counts as a collision.
    """
    contact = records["collision"].astype(int)
    begins = np.flatnonzero((contact != 0) & (contact != np.concatenate([[0], contact[:-1]])))
    kinds: list[int] = [int(kind) for kind in contact[begins]]
    return Collisions(kinds.count(1), kinds.count(2), tuple(float(t) for t in records["time"][begins]))


def stalled_time(records: np.ndarray) -> float:
    """Seconds in which the simulator held the robot back."""
    step = float(np.median(np.diff(records["time"]))) if len(records) > 1 else 0.0
    return float(np.count_nonzero(records["stalled"])) * step


def exploration_time(start: float, finished: dict[str, float]) -> float:
    """Seconds from the start of the mission to the end of the last robot's exploration."""
    if not finished:
        raise ValueError("no robot has finished")
    return max(finished.values()) - start
