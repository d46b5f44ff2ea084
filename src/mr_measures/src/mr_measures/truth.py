"""What maps are compared with: the true walls of a world and the cells that robots can get to know.

All positions in metres, angles in radians.
"""

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple, Optional

import cv2
import numpy as np
from scipy import ndimage

from mr_grid import OccupancyGrid, Pose
from mr_measures.true_world import Polygon, RayCaster, TrueWorld

WALL_MARGIN = 0.1  # m: free cells nearer to a wall than this are no reference cells

_REFERENCE_RESOLUTION = 0.05  # m, lattice of the reference cells
CELL_AREA = _REFERENCE_RESOLUTION**2  # m^2
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
        walls: OccupancyGrid,
        starts: Sequence[Pose],
        footprint: Sequence[Polygon],
        range_max: float,
        cast: RayCaster,
        known: Optional[KnowableArea] = None,
    ) -> None:
        """`walls`: unturned, cells above 0; `starts`: world poses from which the footprint drives; `range_max`: of the
        laser; `cast`: rays in the walls. Takes seconds, unless what can be known from there has been computed before
        (`known`)."""
        pad = math.ceil(_SURROUND / walls.resolution)
        cells = np.pad((walls.cells > 0).astype(np.uint8), pad)
        self._resolution = walls.resolution
        self._origin = np.asarray(walls.origin[:2]) - pad * walls.resolution
        distance, self._nearest = ndimage.distance_transform_edt(cells == 0, return_indices=True)
        # From the centre of a cell to the face of the nearest wall.
        self._distance = distance * walls.resolution - walls.resolution / 2.0
        if known is None:
            self.viewpoints = self._viewpoints(cells, starts, footprint)
            known = KnowableArea(self.viewpoints, self._reference_cells(walls, range_max, cast))
        self.viewpoints, self.knowable = known.viewpoints, known.cells
        self.reference = _centres_of(known.cells, walls)
        self.cell_area = CELL_AREA

    @classmethod
    def of_world(cls, world: TrueWorld, known: Optional[KnowableArea] = None) -> "Truth":
        """Truth for the robots of a world; the footprint and laser are those of the first robot."""
        robot, starts = world.robots[0], [robot.start for robot in world.robots]
        return cls(world.visible, starts, robot.footprint, robot.range_max, world.cast, known)

    def wall_distance(self, points: np.ndarray) -> np.ndarray:
        """Distance (N,) from points (N, 2) to the nearest true wall, 0 inside it, infinite far outside the world."""
        places = (points - self._origin) / self._resolution  # in cells
        index, shape = np.floor(places).astype(np.int64), np.array(self._distance.shape[::-1])
        distance = np.full(len(points), np.inf)
        inside = ((index >= 0) & (index < shape)).all(axis=1)
        # What is nearest to the centre of its cell need not be so to the point: one beside it tells.
        for beside in itertools.product((-1, 0, 1), repeat=2):
            column, row = np.clip(index[inside] + beside, 0, shape - 1).T
            walls = self._nearest[::-1, row, column].T + 0.5
            off = np.maximum(np.abs(places[inside] - walls) - 0.5, 0.0)
            distance[inside] = np.minimum(distance[inside], np.hypot(*off.T) * self._resolution)
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
            if not (0 <= row < labels.shape[1] and 0 <= column < labels.shape[2]):
                continue  # far outside the walls, where there is nothing to know
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

    def _reference_cells(self, walls: OccupancyGrid, range_max: float, cast: RayCaster) -> np.ndarray:
        """The free cells, bool (rows, columns), in view from a viewpoint, without those beside a wall."""
        rows, columns = (math.ceil(n * walls.resolution / _REFERENCE_RESOLUTION - 1e-6) for n in walls.cells.shape)
        seen = np.zeros((rows, columns), dtype=np.uint8)
        angles = np.arange(_BEAMS) * (2.0 * math.pi / _BEAMS)
        beams = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        for point in self.viewpoints:
            ends = point + beams * cast((point[0], point[1]), angles, range_max)[:, None]
            pixels = np.floor((ends - walls.origin[:2]) / _REFERENCE_RESOLUTION).astype(np.int32)
            cv2.fillPoly(seen, [pixels], 1)
        found = seen > 0
        index = np.floor((_centres_of(found, walls) - self._origin) / self._resolution).astype(np.int64)
        found[found] = self._distance[index[:, 1], index[:, 0]] >= WALL_MARGIN
        return found


def _centres_of(cells: np.ndarray, walls: OccupancyGrid) -> np.ndarray:
    """Centres (N, 2) in the world of the cells of the lattice of reference cells, bool (rows, columns)."""
    centres: np.ndarray = (np.argwhere(cells)[:, ::-1] + 0.5) * _REFERENCE_RESOLUTION + walls.origin[:2]
    return centres
