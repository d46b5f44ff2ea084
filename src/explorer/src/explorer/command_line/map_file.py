"""Map files of map_server. Their reader is map_merger's; only the command line uses it, the engine needs no files."""

from explorer.errors import MapError
from explorer.grid import GridInfo, OccupancyMap


def read(path: str) -> OccupancyMap:
    """Raises `MapError` with one line that names the file and what is wrong with it."""
    from map_merger.map_files import MapFileError, read_map

    try:
        grid = read_map(path)
    except MapFileError as error:
        raise MapError(str(error)) from error
    origin = grid.info.origin
    if abs(origin.yaw) > 1e-3:
        raise MapError(f"{path}: the map is rotated by {origin.yaw:g} rad; write it with an unrotated origin")
    height, width = grid.cells.shape
    return OccupancyMap(GridInfo(grid.info.resolution, width, height, origin.x, origin.y), grid.cells)
