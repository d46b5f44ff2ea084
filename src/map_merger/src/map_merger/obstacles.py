"""Connected obstacles of a map."""

from typing import NamedTuple

import numpy as np

from mr_grid.imaging import part_labels


class Obstacles(NamedTuple):
    """Connected obstacles (8 neighbours), numbered from 1; 0 is all the rest, with area 0.

    labels: int32 (rows, columns). cells: int64 (m,), occupied cells counted row by row. label_of: int32 (m,), theirs.
    areas: int64 (n,), cells. boxes: int64 (n, 4), top, left, bottom and right, the last two not included. centres:
    float64 (n, 2), row and column.
    """

    labels: np.ndarray
    cells: np.ndarray
    label_of: np.ndarray
    areas: np.ndarray
    boxes: np.ndarray
    centres: np.ndarray

    def extents(self) -> np.ndarray:
        """Larger side of the box around each, in cells, (n,)."""
        return (self.boxes[:, 2:] - self.boxes[:, :2]).max(axis=1)


def obstacles_of(occupied: np.ndarray) -> Obstacles:
    """The connected obstacles of a map, bool (rows, columns)."""
    cells = np.flatnonzero(occupied)
    if not cells.size:
        none = np.zeros(1, np.int64)
        labels = np.zeros(occupied.shape, np.int32)
        return Obstacles(labels, cells, labels.ravel()[:0], none, np.zeros((1, 4), np.int64), np.zeros((1, 2)))
    # OpenCV's own statistics take several times as long, because they are of the free cells, too.
    count, labels = part_labels(occupied)
    label_of = labels.ravel()[cells]
    order = np.argsort(label_of, kind="stable")
    rows, columns = np.divmod(cells[order], occupied.shape[1])
    starts = np.searchsorted(label_of[order], np.arange(1, count))
    areas = np.bincount(label_of, minlength=count)
    boxes, centres = np.zeros((count, 4), np.int64), np.zeros((count, 2))
    for axis, places in enumerate((rows, columns)):
        boxes[1:, axis] = np.minimum.reduceat(places, starts)
        boxes[1:, axis + 2] = np.maximum.reduceat(places, starts) + 1
        centres[1:, axis] = np.add.reduceat(places, starts) / areas[1:]
    return Obstacles(labels, cells, label_of, areas, boxes, centres)
