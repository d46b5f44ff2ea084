"""Maps of a mission as files: exact ones for the runner, those of map_server and pictures for people."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mr_grid import OccupancyGrid, Pose
from mr_grid.map_files import image_of, write_map

OCCUPIED_FROM, FREE_BELOW = 65, 26  # percent, as map_saver


def free_cells(grid: OccupancyGrid) -> np.ndarray:
    """Bool (rows, columns)."""
    return (grid.cells >= 0) & (grid.cells < FREE_BELOW)


def occupied_cells(grid: OccupancyGrid) -> np.ndarray:
    """Bool (rows, columns)."""
    return grid.cells >= OCCUPIED_FROM


def save_raw(grid: OccupancyGrid, path: Path) -> None:
    """Exact cells for the runner (numpy archive)."""
    temporary = path.with_suffix(".part.npz")
    np.savez(temporary, cells=grid.cells, resolution=grid.resolution, origin=np.array(grid.origin))
    temporary.rename(path)


def load_raw(path: Path) -> OccupancyGrid:
    with np.load(path) as archive:
        return OccupancyGrid.of(archive["cells"], float(archive["resolution"]), Pose(*archive["origin"].tolist()))


def save_map(grid: OccupancyGrid, stem: Path) -> list[Path]:
    """Write ``<stem>.pgm``, ``<stem>.yaml`` and ``<stem>.png``; returns the files."""
    import cv2  # here, for a mission that begins: it is slow to import

    files = [Path(path) for path in write_map(str(stem), grid, FREE_BELOW, OCCUPIED_FROM)]
    picture = stem.with_suffix(".png")
    if not cv2.imwrite(str(picture), image_of(grid, FREE_BELOW, OCCUPIED_FROM)[::-1]):
        raise OSError(f"cannot write {picture}")
    return [*files, picture]
