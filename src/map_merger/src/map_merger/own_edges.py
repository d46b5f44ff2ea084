"""The transforms that a robot has found itself, as edges of the team's graph."""

from typing import List, Optional

from mr_grid import Pose

from .exchange import Exchange
from .graph.edges import Edge
from .messages import Boot
from .registrar import Registrar

_SAME_FRAME = ((1e-8, 0.0, 0.0), (0.0, 1e-8, 0.0), (0.0, 0.0, 1e-8))
"""A base station's frame is that of the robot whose map it has adopted."""


def own_edges(name: str, boot: Boot, registrar: Registrar, exchange: Exchange, base: Optional[str]) -> List[Edge]:
    """Edges of robot `name` in its run `boot`. base: the robot whose map is the own one, on a base station."""
    edges = []
    for robot, alignment in registrar.believed().items():
        belief = alignment.belief
        if belief is not None and belief.covariance is not None:
            run = exchange.boot_of(robot)
            wall = belief.evidence.matched
            edges.append(Edge(name, robot, boot, run, belief.transform, belief.covariance, wall, belief.met))
    if base is not None:
        edges.append(Edge(name, base, boot, exchange.boot_of(base), Pose(), _SAME_FRAME))
    return edges
