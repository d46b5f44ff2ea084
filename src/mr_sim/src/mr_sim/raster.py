"""Obstacles of a world description as a raster of occupied cells."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mr_sim.bitmap import load_bitmap
from mr_sim.bodies import Polygon
from mr_sim.world_description import MAX_CELLS, Obstacle, bounds_of

CELLS_AT_ONCE = 1_000_000  # that are drawn: bounds memory


@dataclass(frozen=True)
class Grid:
    """`cells`: uint8 (rows, columns), 1 = occupied, row 0 at the bottom; `origin`: lower left corner in metres."""

    cells: np.ndarray
    resolution: float
    origin: tuple[float, float]


class _Canvas:
    """Marks cells; a cell is occupied when its centre lies in an obstacle or a fine detail of one lies in the cell."""

    def __init__(self, bounds: tuple[float, float, float, float], resolution: float) -> None:
        # The lattice holds the world's zero; a tiny slack keeps rounding from adding an empty row.
        if not all(math.isfinite(bound / resolution) for bound in bounds):
            raise ValueError(f"resolution {resolution:g} m makes too many cells: choose a coarser one")
        first_column = math.floor(bounds[0] / resolution + 1e-6)
        first_row = math.floor(bounds[1] / resolution + 1e-6)
        columns = max(1, math.ceil(bounds[2] / resolution - 1e-6) - first_column)
        rows = max(1, math.ceil(bounds[3] / resolution - 1e-6) - first_row)
        if rows * columns > MAX_CELLS:
            raise ValueError(f"resolution {resolution:g} m makes {rows} x {columns} cells: choose a coarser one")
        self.resolution = resolution
        self.origin = (first_column * resolution, first_row * resolution)
        self.cells = np.zeros((rows, columns), dtype=np.uint8)

    def _cells_at(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        indices = np.floor((points - self.origin) / self.resolution + 1e-6).astype(np.int64)
        rows, columns = self.cells.shape
        return np.clip(indices[..., 1], 0, rows - 1), np.clip(indices[..., 0], 0, columns - 1)

    def _centres(self, corners: np.ndarray) -> Iterator[tuple[np.ndarray, slice, slice]]:
        """World coordinates (rows, columns, 2) of the cell centres in the bounding box of `corners`, in bands."""
        rows, columns = self._cells_at(corners)
        column_slice = slice(int(columns.min()), int(columns.max()) + 1)
        x = self.origin[0] + (np.arange(column_slice.start, column_slice.stop) + 0.5) * self.resolution
        first, end, height = int(rows.min()), int(rows.max()) + 1, max(1, CELLS_AT_ONCE // len(x))
        for row in range(first, end, height):
            row_slice = slice(row, min(row + height, end))
            y = self.origin[1] + (np.arange(row_slice.start, row_slice.stop) + 0.5) * self.resolution
            yield np.stack(np.meshgrid(x, y), axis=-1), row_slice, column_slice

    def draw(self, obstacle: Obstacle) -> None:
        """Raises WorldFileError for a bitmap without use."""
        if obstacle.bitmap is not None:
            self.draw_bitmap(obstacle, obstacle.bitmap)
        for polygon in obstacle.polygons:
            corners = _place(polygon, obstacle)
            self.draw_polygon(corners)
            if _is_thin(corners, self.resolution):
                self.draw_outline(corners)
        if obstacle.boundary:
            half_x, half_y = obstacle.size[0] / 2.0, obstacle.size[1] / 2.0
            corners = _place(((-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y)), obstacle)
            self.draw_outline(corners)

    def draw_bitmap(self, obstacle: Obstacle, bitmap: Path) -> None:
        pixels = load_bitmap(bitmap)
        rows, columns = pixels.shape
        scale = np.array([obstacle.size[0] / columns, obstacle.size[1] / rows])
        cosine, sine = math.cos(obstacle.pose[2]), math.sin(obstacle.pose[2])
        rotation = np.array([[cosine, -sine], [sine, cosine]])
        half = np.array(obstacle.size) / 2.0
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half @ rotation.T + obstacle.pose[:2]
        for centres, row_slice, column_slice in self._centres(corners):
            local = ((centres - obstacle.pose[:2]) @ rotation + half) / scale
            index = np.floor(local + 1e-6).astype(np.int64)
            inside = ((index >= 0) & (index < [columns, rows])).all(axis=-1)
            index = np.clip(index, 0, [columns - 1, rows - 1])
            self.cells[row_slice, column_slice] |= (inside & pixels[index[..., 1], index[..., 0]]).astype(np.uint8)
        if scale.min() < self.resolution:
            occupied = np.argwhere(pixels)[:, ::-1] + 0.5
            self.cells[self._cells_at((occupied * scale - half) @ rotation.T + obstacle.pose[:2])] = 1

    def draw_polygon(self, corners: np.ndarray) -> None:
        for centres, row_slice, column_slice in self._centres(corners):
            inside = np.zeros(centres.shape[:2], dtype=bool)
            x, y = centres[..., 0], centres[..., 1]
            for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
                if a[1] != b[1]:
                    crossing = (a[1] > y) != (b[1] > y)
                    inside ^= crossing & (x < (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]) + a[0])
            self.cells[row_slice, column_slice] |= inside.astype(np.uint8)

    def draw_outline(self, corners: np.ndarray) -> None:
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            count = int(np.ceil(2.0 * np.hypot(*(b - a)) / self.resolution)) + 1
            self.cells[self._cells_at(a + (b - a) * np.linspace(0.0, 1.0, count)[:, None])] = 1


def _is_thin(corners: np.ndarray, resolution: float) -> bool:
    """Whether a polygon is so thin that cell centres may miss it."""
    edges = np.roll(corners, -1, axis=0) - corners
    area = 0.5 * abs(np.sum(corners[:, 0] * edges[:, 1] - corners[:, 1] * edges[:, 0]))
    return area < resolution * np.hypot(edges[:, 0], edges[:, 1]).sum()


def _place(polygon: Polygon, obstacle: Obstacle) -> np.ndarray:
    return np.array([obstacle.pose.apply_point(x, y) for x, y in polygon])


def closed_plan(obstacles: Sequence[Obstacle]) -> Obstacle | None:
    """The bitmap of a world that has nothing else, if there are walls all around it and room within, as maps have.
    Where there is more, robots may well start beside it."""
    if len(obstacles) != 1 or obstacles[0].bitmap is None or not obstacles[0].solid:
        return None
    pixels = load_bitmap(obstacles[0].bitmap)
    edges = (pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1])
    return obstacles[0] if all(edge.all() for edge in edges) and not pixels.all() else None


def write_image(grid: Grid, path: str | Path) -> None:
    """Write a raster as binary PGM: walls black, the uppermost row first."""
    pixels = np.where(np.flipud(grid.cells) != 0, 0, 255).astype(np.uint8)
    Path(path).write_bytes(b"P5 %d %d 255\n" % pixels.shape[::-1] + pixels.tobytes())


def rasterise(obstacles: Sequence[Obstacle], resolution: float) -> Grid:
    """Raster of the given obstacles at `resolution` metres. Raises WorldFileError for a bitmap without use."""
    canvas = _Canvas(bounds_of(obstacles), resolution)
    for obstacle in obstacles:
        canvas.draw(obstacle)
    return Grid(canvas.cells, resolution, canvas.origin)


def intensities_of(obstacles: Sequence[Obstacle], resolution: float) -> np.ndarray | None:
    """Of the echoes from the cells of `rasterise`, float32, same shape: the `ranger_return` of what is there, or of one
    of those that overlap; 0 where nothing is. None if all have 1."""
    values = dict.fromkeys(obstacle.ranger_return for obstacle in obstacles)
    if set(values) <= {1.0}:
        return None
    bounds = bounds_of(obstacles)
    intensities = np.zeros(_Canvas(bounds, resolution).cells.shape, dtype=np.float32)
    for value in values:
        canvas = _Canvas(bounds, resolution)
        for obstacle in obstacles:
            if obstacle.ranger_return == value:
                canvas.draw(obstacle)
        intensities[canvas.cells > 0] = value
    return intensities
