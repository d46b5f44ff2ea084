"""The map that a robot plans on: its own, and where that says nothing the one that another robot made of the scene."""

import numpy as np

from mr_grid import OccupancyGrid, Pose
from mr_sim.raster import rasterise
from mr_sim.world_description import WorldDescription

BORDER = 1.0  # m around the scene


class MergedMap:
    """Own known cells stay as they are, as `map_merger` has it."""

    def __init__(self, world: WorldDescription, error: Pose) -> None:
        """`error`: where the other robot's map is drawn, from where it belongs."""
        self._truth = rasterise(world.obstacles, world.resolution)
        self._error = error

    def of(self, own: OccupancyGrid, start: Pose) -> OccupancyGrid:
        """`start`: of the robot in the world, where its map frame lies. On the lattice of the own map."""
        shape = np.array(self._truth.cells.shape) * self._truth.resolution
        corners = [
            start.inverse().apply_point(self._truth.origin[0] + x, self._truth.origin[1] + y)
            for x in (-BORDER, shape[1] + BORDER)
            for y in (-BORDER, shape[0] + BORDER)
        ]
        corner = np.array(own.origin[:2])
        far = corner + np.array(own.cells.shape[::-1]) * own.resolution
        low, high = np.minimum(np.min(corners, axis=0), corner), np.maximum(np.max(corners, axis=0), far)
        left, bottom = np.ceil((corner - low) / own.resolution - 1e-6).astype(int)
        origin = (own.origin[0] - left * own.resolution, own.origin[1] - bottom * own.resolution)
        columns, rows = np.ceil((high - origin) / own.resolution - 1e-6).astype(int)
        cells = self._drawn(int(rows), int(columns), own.resolution, origin, start)
        window = cells[bottom : bottom + own.cells.shape[0], left : left + own.cells.shape[1]]
        np.copyto(window, own.cells, where=own.cells >= 0)
        return OccupancyGrid.of(cells, own.resolution, Pose(*origin))

    def _drawn(
        self, rows: int, columns: int, resolution: float, origin: tuple[float, float], start: Pose
    ) -> np.ndarray:
        """The other robot's map on a lattice in the frame of a robot that started there."""
        row, column = np.indices((rows, columns))
        frame = self._error.between(start)
        x, y = origin[0] + (column + 0.5) * resolution, origin[1] + (row + 0.5) * resolution
        c, s = np.cos(frame[2]), np.sin(frame[2])
        there_x, there_y = frame[0] + c * x - s * y, frame[1] + s * x + c * y
        r = np.floor((there_y - self._truth.origin[1]) / self._truth.resolution).astype(int)
        k = np.floor((there_x - self._truth.origin[0]) / self._truth.resolution).astype(int)
        height, width = self._truth.cells.shape
        inside = (r >= 0) & (k >= 0) & (r < height) & (k < width)
        cells = np.full((rows, columns), -1, np.int8)
        cells[inside] = 100 * self._truth.cells[r[inside], k[inside]].astype(np.int8)
        return cells
