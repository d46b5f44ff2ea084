"""Places that only a slimmer robot could look at: how narrow the way there is, to be told to people."""

import math
from typing import Dict, Optional, Sequence

from explorer.frontiers import Frontier, points_of
from explorer.geometry import Position
from explorer.travel import CostField
from explorer.views import Views
from explorer.ways import Ways

SLIMMER = 0.4  # of the robot's radius: what is narrower than that is a gap in a wall that was badly drawn
NARROW = "too narrow: {:.1f} m"


class SlimmerRobot:
    """One that stands where this robot does. A function of the map and of that place."""

    def __init__(
        self, ways: Ways, field: CostField, place: Position, view_distance: float, like: Optional["SlimmerRobot"] = None
    ) -> None:
        """`ways`, `field`: this robot's, which is at `place`, in metres. `like`: at any earlier time; what still holds
        is not computed again."""
        former = None if like is None else like._ways
        self._ways: Ways = Ways(ways.occupancy, SLIMMER * ways.radius, ways.robots, ways.largest, former=former)
        self._wide, self._wide_field = ways, field
        self._field = self._ways.grid.field_from(*place)
        self._views = Views(ways.occupancy, self._field, view_distance)

    def reasons(self, unseen: Sequence[Frontier]) -> Dict[int, str]:
        """{number: reason} of those of the points, which this robot sees from nowhere, that the slimmer one would see
        from beyond where this one can be."""
        views = zip(unseen, self._views.of(points_of(unseen)))
        widths = {frontier.number: self._width(*view[:2]) for frontier, view in views if view is not None}
        return {number: NARROW.format(width) for number, width in widths.items() if width < 2.0 * self._wide.radius}

    def _width(self, x: float, y: float) -> float:
        """m, of the narrowest place on the slimmer robot's way to (x, y), metres, from where this one can go no farther
        on; infinite where that is not for want of width."""
        path = self._field.path_to(x, y)
        info, reachable = self._wide_field.grid.info, self._wide_field.reachable
        common = [index for index, place in enumerate(path) if reachable[info.cell_of(*place)]]
        beyond = path[common[-1] + 1 :] if common else []
        return 2.0 * min((self._ways.grid.clearance_at(*place) for place in beyond), default=math.inf)
