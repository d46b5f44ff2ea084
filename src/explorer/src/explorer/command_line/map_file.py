"""Map files of map_server for the command line; the engine needs no files."""

from dataclasses import replace

from explorer.errors import MapError
from explorer.grid import OccupancyMap
from mr_grid import Pose
from mr_grid.map_files import MapFileError, read_map


def read(path: str) -> OccupancyMap:
    """Raises `MapError` with one line that names the file and what is wrong with it."""
    try:
        grid = read_map(path)
    except MapFileError as error:
        raise MapError(str(error)) from error
    x, y, yaw = grid.origin
    if abs(yaw) > 1e-3:
        raise MapError(f"{path}: the map is rotated by {yaw:g} rad; write it with an unrotated origin")
    return OccupancyMap(replace(grid.info, origin=Pose(x, y)), grid.cells)
