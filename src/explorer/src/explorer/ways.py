"""Ways over one map, from any robot and between any places, each computed when it is first asked for."""

from functools import cached_property
from typing import Dict, Optional, Sequence, Tuple

import numpy as np

from explorer.geometry import Position
from explorer.grid import OccupancyMap
from explorer.ground import Ground
from explorer.tour import ways_between
from explorer.travel import CostField, TravelGrid, factor_for

COMFORT = 0.35  # m more than the robot has to keep from obstacles: cells that are nearer cost more
TOUR_CELL = 0.2  # m, resolution at which ways between clusters are measured
FEWEST_FIELDS = 8  # of other robots' costs that are kept, more in a larger team


class Ways:
    """A function of a map and of the robots on it; what was computed is kept."""

    def __init__(
        self,
        occupancy: OccupancyMap,
        radius: float,
        robots: Sequence[Position],
        largest: float,
        team: int = 0,
        former: Optional["Ways"] = None,
    ) -> None:
        """`radius`: of the robot in metres. `robots`: places of the others in metres, whose traces on the map are no
        obstacles. `largest`: radius of the largest robot of the team in metres. `team`: number of robots for which
        costs are kept. `former`: over any earlier map; what still holds of it is not computed again."""
        self.occupancy = occupancy
        self.radius, self.largest, self.robots = radius, largest, tuple(robots)
        self.comfort = radius + COMFORT
        self._kept = max(FEWEST_FIELDS, team)
        ground = Ground.of(occupancy, radius, robots, largest, None if former is None else former.grid.ground)
        self._fields: Dict[Position, CostField] = {}
        if former is not None and former.grid.ground is ground:
            self.grid: TravelGrid = former.grid
            self._fields.update(former._fields)
        else:
            self.grid = TravelGrid(occupancy, radius, self.comfort, ground=ground)

    def from_robot(self, position: Position) -> CostField:
        """Costs from near another robot's place, the same for half a metre around."""
        place = place_near(position)
        field = self._fields.pop(place, None)
        if field is None:
            field = self.grid.field_from(*place)
            while len(self._fields) >= self._kept:
                del self._fields[next(iter(self._fields))]
        self._fields[place] = field  # the last one used comes last
        return field

    def between(self, stops: Sequence[Tuple[float, float]]) -> np.ndarray:
        """(n, n) path lengths in metres between n places, infinite where no path leads."""
        return ways_between(self._tour_grid, stops)

    @cached_property
    def _tour_grid(self) -> TravelGrid:
        if factor_for(self.grid.ground, TOUR_CELL) == self.grid.factor:
            return self.grid
        return TravelGrid(self.occupancy, self.radius, self.comfort, cell=TOUR_CELL, ground=self.grid.ground)


def place_near(position: Position) -> Position:
    """The place that stands for all within about half a metre in `Ways.from_robot`, in metres."""
    return (round(2 * position[0]) / 2, round(2 * position[1]) / 2)


def known_near(occupancy: OccupancyMap, x: float, y: float, reach: float = 1.0) -> int:
    """Number of known cells in the square of half edge `reach` around a point, both in metres."""
    row, col = occupancy.info.cell_of(x, y)
    cells = int(reach / occupancy.info.resolution)
    window = occupancy.cells[max(0, row - cells) : row + cells + 1, max(0, col - cells) : col + cells + 1]
    return int(np.count_nonzero(window >= 0))
