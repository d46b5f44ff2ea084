"""Pictures of a world: dark pixels are solid."""

import os
from pathlib import Path

import numpy as np

from mr_sim.world_file import WorldFileError

OCCUPIED_BELOW = 128  # level of a pixel under which it is wall
RED = 2  # channel of a picture that Stage looks at

Rectangle = tuple[int, int, int, int]
"""First column and row, then the column and row behind the last; row 0 at the bottom."""


def read_image(path: str | Path) -> np.ndarray | None:
    """uint8 (rows, columns, 3), blue first; None for what is no picture, or too large a one."""
    import cv2  # here, for who needs no picture: it is slow to import

    try:
        return cv2.imread(str(path), cv2.IMREAD_COLOR) if os.path.isfile(path) else None
    except cv2.error:
        return None


def why_no_image(path: str | Path) -> str:
    """Why `read_image` gave None, as the end of a sentence."""
    if not os.path.isfile(path):
        return "is no file"
    return "is no image that can be read (pgm, png, jpg, bmp), or too large a one"


def load_bitmap(path: str | Path) -> np.ndarray:
    """Occupied pixels, bool (rows, columns), row 0 at the bottom, cropped to their bounding box as Stage does. Raises
    WorldFileError."""
    image = read_image(path)
    if image is None:
        raise WorldFileError(str(path), why_no_image(path))
    occupied = np.flipud(image[..., RED] < OCCUPIED_BELOW)
    rows, columns = np.flatnonzero(occupied.any(axis=1)), np.flatnonzero(occupied.any(axis=0))
    if rows.size == 0:
        raise WorldFileError(str(path), "has no dark pixel, so no walls")
    return occupied[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def rectangles(pixels: np.ndarray) -> list[Rectangle]:
    """Rectangles that together are the True `pixels`, bool (rows, columns): runs, joined with equal ones above."""
    done: list[Rectangle] = []
    growing: dict[tuple[int, int], int] = {}  # columns of a run -> row it began in
    for row, line in enumerate([*pixels, np.zeros(pixels.shape[1], dtype=bool)]):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], line.astype(np.int8), [0]])))
        runs = {(int(begin), int(end)) for begin, end in zip(edges[::2], edges[1::2], strict=True)}
        for run in growing.keys() - runs:
            done.append((run[0], growing.pop(run), run[1], row))
        for run in runs - growing.keys():
            growing[run] = row
    return sorted(done)
