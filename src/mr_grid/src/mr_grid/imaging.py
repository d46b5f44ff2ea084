"""What the nodes of a robot take from OpenCV's imgproc, without what ``import cv2`` loads with it.

cv2 is linked to all of OpenCV, to codecs, VTK and Qt, and a process that needs no more than connected parts loads them
all. Arrays are (rows, columns) and not empty; masks are bool.
"""

from typing import NamedTuple, Tuple

import numpy as np

from mr_grid import _imaging

OPENCV_VERSION: str = _imaging.OPENCV_VERSION


class Parts(NamedTuple):
    """Cells that hang together (8 neighbours), numbered from 1 on; 0 is all the rest.

    labels: int32 (rows, columns). boxes: int32 (n, 4), the left column, the top row, how many columns and rows. areas:
    int32 (n,), cells. middles: float64 (n, 2), column and row.
    """

    labels: np.ndarray
    boxes: np.ndarray
    areas: np.ndarray
    middles: np.ndarray

    def extents(self) -> np.ndarray:
        """Larger side of the box around each, in cells, (n,)."""
        return self.boxes[:, 2:].max(axis=1)


def use_threads(count: int) -> None:
    """How many threads OpenCV takes in this process, cv2 included."""
    _imaging.use_threads(count)


def parts_of(mask: np.ndarray) -> Parts:
    labels, statistics, middles = _imaging.parts(mask)
    return Parts(labels, statistics[:, :4], statistics[:, 4], middles)


def part_labels(mask: np.ndarray) -> Tuple[int, np.ndarray]:
    """How many parts there are, with the rest, and the `labels` of them: several times as fast as `parts_of`."""
    return _imaging.part_labels(mask)


def dilated(image: np.ndarray, side: int) -> np.ndarray:
    """The largest value in the square of side x side cells around each cell; bool or float32, as the image."""
    return _imaging.dilated(np.ascontiguousarray(image), side)


def eroded(mask: np.ndarray, shape: np.ndarray) -> np.ndarray:
    """Cells around which all of `shape` (uint8, 1 for its cells) is set; nothing is missing beyond the edge."""
    return _imaging.eroded(mask, shape)


def blurred(image: np.ndarray, sigma: float) -> np.ndarray:
    """By a Gaussian of `sigma` cells; float32."""
    return _imaging.blurred(image, sigma)


def box_means(image: np.ndarray, side: int) -> np.ndarray:
    """The mean of the square of side x side cells around each cell; float32."""
    return _imaging.box_means(image, side)


def nearest_set(mask: np.ndarray) -> np.ndarray:
    """For each cell the number of the nearest one that is set, from 1 on in the order of rows: int32."""
    return _imaging.nearest_zero(~mask)


def largest_contour(mask: np.ndarray) -> np.ndarray:
    """The outer contour that encloses most, (n, 2), columns and rows. Raises ValueError if no cell is set."""
    return _imaging.largest_contour(mask)


def simplified(contour: np.ndarray, tolerance: float) -> np.ndarray:
    """A closed contour (n, 2) with fewer points, nowhere farther off than `tolerance`."""
    return _imaging.simplified(contour, tolerance)


def draw_circle(image: np.ndarray, column: int, row: int, radius: int, grey: int) -> None:
    """One pixel thick, onto the image (uint8)."""
    _imaging.draw_circle(image, column, row, radius, grey)
