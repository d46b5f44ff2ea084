"""Where the frames of the other robots lie in the own one, as far as that is believed."""

from typing import Dict

from mr_grid import Pose

from .graph.team import Placement, TeamGraph
from .reference import Reference


class BelievedTransforms:
    """What the team's graph says, seen from the own frame. Holds nothing itself."""

    def __init__(self, graph: TeamGraph, reference: Reference) -> None:
        self._graph, self._reference = graph, reference

    def placements(self) -> Dict[str, Placement]:
        """Of each robot that is placed."""
        placed, base = self._graph.placed(), self._reference.robot
        if base not in placed:
            return placed
        # The graph lets every robot give way a little; a base station's frame is that of the robot by definition.
        return {**placed, base: placed[base]._replace(transform=Pose())}

    def transforms(self) -> Dict[str, Pose]:
        """Of each placed robot's map frame to the own one."""
        return {name: placement.transform for name, placement in self.placements().items()}
