"""Maps as pictures in a record."""

from __future__ import annotations

import base64
from dataclasses import dataclass

import numpy as np

from mr_grid import OccupancyGrid
from mr_measures.figures import FREE_BELOW, OCCUPIED_FROM

OCCUPIED, UNKNOWN, FREE = 0, 205, 254  # gray values, as in the files of map_server


@dataclass(frozen=True)
class Picture:
    """`png`: in base64, north up; `resolution`: m; `origin`: lower left corner, m."""

    png: str
    resolution: float
    origin: tuple[float, float]


def picture_of(occupancy: OccupancyGrid) -> Picture:
    """Of a map that is not turned."""
    import cv2  # here, for programs that read records alone

    gray = np.full(occupancy.cells.shape, UNKNOWN, dtype=np.uint8)
    gray[(occupancy.cells >= 0) & (occupancy.cells < FREE_BELOW)] = FREE
    gray[occupancy.cells >= OCCUPIED_FROM] = OCCUPIED
    done, octets = cv2.imencode(".png", gray[::-1])
    if not done:
        raise ValueError(f"a map of {gray.shape} cells makes no picture")
    x, y = round(occupancy.origin[0], 4), round(occupancy.origin[1], 4)
    return Picture(base64.b64encode(octets.tobytes()).decode(), round(occupancy.resolution, 6), (x, y))
