"""What the agents tell one another, as plain values. `ros_io` converts them to the messages of the contract."""

from dataclasses import dataclass
from typing import NamedTuple, Tuple

import numpy as np

from mr_grid import GridInfo, Pose

from .grid import Box

Boot = Tuple[int, int]
"""Names one run of a robot (its start time as seconds and nanoseconds). Only ever compared for equality."""

NO_BOOT: Boot = (0, 0)
"""A sender that does not tell; it matches every run."""

USUAL_RESOLUTION_M = 0.05
"""That of gmapping and of the original, which knows no other."""


class Anchor(NamedTuple):
    """Corner and resolution from which the tile offsets of a robot count, fixed per run. `updates`: numbers used so
    far."""

    robot: str
    info: GridInfo
    boot: Boot
    updates: int = 0


def run_after(boot: Boot, count: int) -> Boot:
    """Names the run that begins in the same process after `count` others."""
    seconds, nanoseconds = divmod(boot[1] + count, 1_000_000_000)
    return boot[0] + seconds, nanoseconds


@dataclass(frozen=True, eq=False)
class Tile:
    """Cells (int8) at `row`, `column` from the anchor's corner, and the update numbers that they complete.

    `whole`: cells of -1 are unknown. Otherwise they say nothing, as those of the original. `resolution`: 0 of a sender
    that does not tell, as the original.
    """

    robot: str
    numbers: Tuple[int, ...]
    row: int
    column: int
    cells: np.ndarray
    resolution: float
    boot: Boot = NO_BOOT
    updates: int = 0
    whole: bool = False

    @property
    def box(self) -> Box:
        """The cells covered, counted from the anchor's corner."""
        return Box(self.row, self.column, self.row + self.cells.shape[0], self.column + self.cells.shape[1])


class Request(NamedTuple):
    """`robot` asks for these updates; an empty list asks for everything, a first number of -1 for nothing."""

    robot: str
    numbers: Tuple[int, ...]


class Position(NamedTuple):
    """Pose of a robot in its own map frame. sent: when, s, by the clock of the robot; 0 if it does not tell."""

    robot: str
    pose: Pose
    sent: float = 0.0


LONGEST_DELAY_S = 60.0
"""Nothing is under way for longer. What is dated farther back is of a clock that was set since."""
_EARLIEST_S = 1e9
"""Smaller numbers are not times of a real clock, as those of a simulation."""


def sent_before(position: Position, run: Boot) -> bool:
    """True if the position is a late one of a former run: it was sent shortly before the robot's present run began.

    Positions do not name their run, but are dated by the clock after whose time runs are named. Where that is not so,
    as in a simulation, a late one is taken, and counts until the next one comes."""
    return position.sent > _EARLIEST_S and 0.0 < run[0] + 1e-9 * run[1] - position.sent < LONGEST_DELAY_S
