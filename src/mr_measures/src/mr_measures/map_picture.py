"""Maps as pictures in a record."""

from __future__ import annotations

import base64
from typing import Any

import cv2
import numpy as np

from mr_grid import OccupancyGrid
from mr_measures.figures import FREE_BELOW, OCCUPIED_FROM

OCCUPIED, UNKNOWN, FREE = 0, 205, 254  # gray values, as in the files of map_server


def picture_of(occupancy: OccupancyGrid) -> dict[str, Any]:
    """PNG in base64, north up, with the resolution in m and the lower left corner in m."""
    gray = np.full(occupancy.cells.shape, UNKNOWN, dtype=np.uint8)
    gray[(occupancy.cells >= 0) & (occupancy.cells < FREE_BELOW)] = FREE
    gray[occupancy.cells >= OCCUPIED_FROM] = OCCUPIED
    done, octets = cv2.imencode(".png", gray[::-1])
    if not done:
        raise ValueError(f"a map of {gray.shape} cells makes no picture")
    return {
        "png": base64.b64encode(octets.tobytes()).decode(),
        "resolution": round(occupancy.resolution, 6),
        "origin": [round(occupancy.origin[0], 4), round(occupancy.origin[1], 4)],
    }
