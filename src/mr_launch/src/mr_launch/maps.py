"""Occupancy grids as values and as files in the format of map_server (.pgm with .yaml)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

OCCUPIED_FROM = 65  # percent, as map_saver
FREE_TO = 25
PGM_OCCUPIED, PGM_FREE, PGM_UNKNOWN = 0, 254, 205


@dataclass(frozen=True)
class Grid:
    """A map. ``cells`` is int8 (rows, columns), row 0 at the lowest y: -1 unknown, 0 free to 100 occupied.

    ``origin`` is the corner of cell (0, 0): x, y in m in the frame of the map; ``resolution`` in m per cell.
    """

    cells: np.ndarray
    resolution: float
    origin: tuple[float, float]

    @property
    def free(self) -> np.ndarray:
        return (self.cells >= 0) & (self.cells <= FREE_TO)

    @property
    def occupied(self) -> np.ndarray:
        return self.cells >= OCCUPIED_FROM


def save_raw(grid: Grid, path: Path) -> None:
    """Exact cells for the runner (numpy archive)."""
    temporary = path.with_suffix(".part.npz")
    np.savez(temporary, cells=grid.cells, resolution=grid.resolution, origin=np.array(grid.origin))
    temporary.rename(path)


def load_raw(path: Path) -> Grid:
    with np.load(path) as archive:
        x, y = (float(value) for value in archive["origin"])
        return Grid(archive["cells"], float(archive["resolution"]), (x, y))


def to_pixels(grid: Grid) -> np.ndarray:
    """Grey picture (uint8, first row = highest y) with the three values of map_server."""
    pixels = np.full(grid.cells.shape, PGM_UNKNOWN, np.uint8)
    pixels[grid.free] = PGM_FREE
    pixels[grid.occupied] = PGM_OCCUPIED
    return np.flipud(pixels)


def save_map(grid: Grid, stem: Path) -> list[Path]:
    """Write ``<stem>.pgm``, ``<stem>.yaml`` and ``<stem>.png``; returns the files."""
    pixels = np.ascontiguousarray(to_pixels(grid))
    files = [stem.with_suffix(suffix) for suffix in (".pgm", ".yaml", ".png")]
    for path in (files[0], files[2]):
        if not cv2.imwrite(str(path), pixels):
            raise OSError(f"cannot write {path}")
    files[1].write_text(
        f"image: {files[0].name}\n"
        f"resolution: {grid.resolution:.6f}\n"
        f"origin: [{grid.origin[0]:.6f}, {grid.origin[1]:.6f}, 0.000000]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return files
