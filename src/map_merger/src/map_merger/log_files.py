"""Contents of the files that ~logOutput and `debug` write (contract 2.7). Pure: the node does the writing."""

from enum import IntFlag

import numpy as np

from mr_grid import OccupancyGrid
from mr_grid.imaging import draw_circle
from mr_grid.map_files import image_of

from .report import LogFigures


class LogBits(IntFlag):
    """Bits of the request of ~logOutput."""

    GLOBAL_MAP = 0x01
    LOCAL_MAP = 0x02
    LOCAL_PROGRESS = 0x04
    GLOBAL_PROGRESS = 0x08


PROGRESS = LogBits.LOCAL_PROGRESS | LogBits.GLOBAL_PROGRESS
PERIODICAL_HEADER = "# time_s global_free_cells local_free_cells x_m y_m updates_sent transforms_known\n"
UPDATES_HEADER = "# time_s updates_sent\n"


def picture_of(grid: OccupancyGrid, mark_start: bool = True) -> bytes:
    """The map as binary PGM, row r of the picture being row r of the grid; a circle marks the origin of the map
    frame."""
    image = image_of(grid)
    if mark_start and image.size:
        rows, columns = grid.info.continuous_cells(np.zeros((1, 2)))
        draw_circle(image, int(columns[0]), int(rows[0]), 5, 128)
    return b"P5\n%d %d\n255\n" % (grid.info.width, grid.info.height) + image.tobytes()


def periodical_line(now: float, figures: LogFigures, bits: LogBits) -> str:
    """One line of periodical.log; counts that were not asked for are 0."""
    global_free = figures.global_free if bits & LogBits.GLOBAL_PROGRESS else 0
    local_free = figures.local_free if bits & LogBits.LOCAL_PROGRESS else 0
    return (
        f"{now:.3f} {global_free} {local_free} {figures.x:.3f} {figures.y:.3f} "
        f"{figures.updates_sent} {figures.transforms}\n"
    )


def updates_line(now: float, figures: LogFigures) -> str:
    """One line of updates_log."""
    return f"{now:.3f} {figures.updates_sent}\n"
