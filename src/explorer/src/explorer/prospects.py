"""What is unknown behind frontier points, and whether the robot could go there."""

from typing import Dict, NamedTuple, Sequence

import numpy as np

from explorer._kernels import cells_within, connected_part, unknown_behind
from explorer.frontiers import Frontier, points_of
from explorer.geometry import Position
from explorer.travel import SNAP_DISTANCE, nearest_cell
from explorer.ways import Ways
from mr_grid.imaging import dilated

REACH = 2.0  # m that is looked into the unknown
ENTRY = 2.5  # m of way into the unknown that the robot might take; compared on the office, seeds 6601 to 6606
SKIPPED = 0.15  # m of known cells between a frontier point and the unknown


class Prospect(NamedTuple):
    """What is seen from a frontier point: m^2 of unknown `area`, m^2 of it where the robot's centre might come to be,
    `enterable`, and the `depth` of the unknown in m. `passable`: the robot's centre may be at the point itself."""

    area: float
    enterable: float
    depth: float
    passable: bool


def prospects(frontiers: Sequence[Frontier], ways: Ways, place: Position) -> Dict[int, Prospect]:
    """{number: prospect} of these points for a robot at `place`, metres."""
    if not frontiers:
        return {}
    occupancy = ways.occupancy
    info, resolution = occupancy.info, occupancy.info.resolution
    cells = info.cells_of(points_of(frontiers))
    cells = np.clip(cells, 0, np.array((info.height - 1, info.width - 1)))
    areas, depths = unknown_behind(
        occupancy.cells,
        occupancy.OCCUPIED_FROM,
        enterable(ways, place),
        cells,
        round(REACH / resolution),
        max(1, round(SKIPPED / resolution)),
    )
    fits = ways.grid.ground.layers.fits[cells[:, 0], cells[:, 1]]
    rows = zip(frontiers, (areas * resolution**2).tolist(), (depths * resolution).tolist(), fits.tolist())
    return {f.number: Prospect(area, inner, depth, fit) for f, (area, inner), depth, fit in rows}


def enterable(ways: Ways, place: Position) -> np.ndarray:
    """bool, of the map's shape: where the centre of the robot, now at `place` in metres, might come to stand if
    everything unknown were free, up to `ENTRY` beyond what is known: farther away the unknown may be outside of the
    walls."""
    layers, info = ways.grid.ground.layers, ways.occupancy.info
    start = nearest_cell(layers.allowed, info, *place, SNAP_DISTANCE)
    if start is None:
        return layers.enterable
    part = connected_part(layers.allowed, *start)
    ahead = layers.enterable & ~part
    return part | cells_within(ahead, np.flatnonzero(dilated(part, 3) & ahead), round(ENTRY / info.resolution))
