"""The two topologies of the paper: who sends its map to whom, who registers maps, and what a global map is made of.

Distributed: every robot sends its local map to all others and merges for itself. Centralized: robots send theirs to a
base only, which merges them, and sends the merged map and all transforms to every robot.
"""

from dataclasses import dataclass
from typing import Optional

from .effects import GROUP_PREFIX
from .options import Options


@dataclass(frozen=True)
class Topology:
    """Seen from `robot`. base: the one that merges for all; None in the distributed topology."""

    robot: str
    base: Optional[str] = None

    @property
    def is_base(self) -> bool:
        """True if this robot merges for all: the map that it sends is the merged one."""
        return self.base == self.robot

    @property
    def relies_on(self) -> Optional[str]:
        """The base, if another robot is that and merges for this one. Only with that one maps are exchanged."""
        return None if self.is_base else self.base

    @property
    def map_destination(self) -> str:
        """Robot or group to which anchors and changes of the map go."""
        return self.relies_on or GROUP_PREFIX + self.robot

    def exchanges_maps_with(self, robot: str) -> bool:
        """True if the robot's map is asked for and drawn here, and this robot's is told to it."""
        return self.relies_on in (None, robot)

    def why_not_placed(self, robot: str, present: bool, placed: bool) -> str:
        """In words, if another one merges. present: that base is in hearing. placed: it has placed this robot."""
        base = self.relies_on
        if not present:
            return f"base station {base} is not heard"
        if not placed:
            return f"base station {base} has not placed this robot yet"
        return f"base station {base} has not placed {robot} yet"


def topology_of(options: Options) -> Topology:
    """The one that the parameters ask for."""
    return Topology(options.robot_name, options.base_station if options.centralized else None)
