"""Drawing foreign maps on the lattice of the own one."""

from typing import NamedTuple, Optional, Tuple

import numpy as np

from mr_grid import GridInfo, OccupancyGrid, Pose

from . import _surfaces
from .grid import Box, box_around, window
from .transform import rotation_between

STILL_M, STILL_RAD = 0.005, 0.03 * np.pi / 180.0
"""A transform that changes by less moves hardly a cell, and nothing is drawn anew."""
_ROUNDING = 1e-3
"""Shift of a lattice in cells, or share of a resolution, that is only rounding."""


def nearly(first: Pose, second: Pose) -> bool:
    """True if redrawing with the other transform would hardly move a cell."""
    apart = np.hypot(first.x - second.x, first.y - second.y)
    return bool(apart < STILL_M and rotation_between(first, second) < STILL_RAD)


def whole_shift(info: GridInfo, reference: GridInfo) -> Optional[Tuple[int, int]]:
    """(row, column) of the first cell of `info` on the lattice of `reference`; None if the lattices differ."""
    if info.resolution != reference.resolution or info.origin.yaw != reference.origin.yaw:
        return None
    corner = reference.origin.inverse().compose(info.origin)
    row, column = corner.y / info.resolution, corner.x / info.resolution
    if max(abs(row - round(row)), abs(column - round(column))) > _ROUNDING:
        return None
    return round(row), round(column)


class Mapping(NamedTuple):
    """Between the cells of a foreign map and a lattice: (x0, x1, x2, y0, y1, y2) of `_surfaces.draw`."""

    to_source: Tuple[float, ...]
    to_target: Tuple[float, ...]


def _affine(begin: GridInfo, end: GridInfo, transform: Pose) -> Tuple[float, ...]:
    """Cells of `begin` -> position in `end`, with `transform` from the frame of `begin` to that of `end`."""
    middles = begin.centres(np.array([0, 0, 1]), np.array([0, 1, 0]))
    rows, columns = end.continuous_cells(transform.apply(middles))
    return tuple(float(value) for at in (columns, rows) for value in (at[0], at[1] - at[0], at[2] - at[0]))


def mapping_of(source: GridInfo, transform: Pose, lattice: GridInfo) -> Mapping:
    """Of a map whose frame `transform` brings to that of the lattice."""
    return Mapping(_affine(lattice, source, transform.inverse()), _affine(source, lattice, transform))


def box_of(source: GridInfo, part: Box, transform: Pose, lattice: GridInfo) -> Box:
    """The cells of the lattice that cells of `part` of the source can be drawn in."""
    return box_around(lattice, transform.apply(window(source, part).corners())).grown(1)


def drawn(source: OccupancyGrid, part: Box, transform: Pose, lattice: GridInfo, box: Box) -> np.ndarray:
    """The source on the cells `box` of the lattice, int8; `part`: the source's cells that can fall into it.

    Each cell takes the value of the foreign cell under its middle, which keeps walls as thick as they are. Walls that
    hang together only at the corners of cells may break that way, so those links are drawn as well, and those of a
    finer map, whose cells could be missed, as a whole. A cell does not depend on the box it is drawn with.
    """
    mapping = mapping_of(source.info, transform, lattice)
    return _surfaces.draw(
        source.cells,
        mapping.to_source,
        mapping.to_target,
        (part.top, part.left, part.bottom, part.right),
        (box.top, box.left, box.bottom, box.right),
        source.info.resolution < (1.0 - _ROUNDING) * lattice.resolution,
    )
