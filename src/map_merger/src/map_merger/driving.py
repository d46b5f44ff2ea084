"""Which robots have a frame that should be known here."""

from typing import List

from .exchange import Exchange
from .topology import Topology
from .whereabouts import Whereabouts


def driving(topology: Topology, exchange: Exchange, whereabouts: Whereabouts) -> List[str]:
    """Robots in hearing that have a map or a position; who has neither, like a base station, has no frame. Where a base
    merges, it is for that one to say."""
    heard = [robot for robot in exchange.robots() if exchange.present(robot)]
    if topology.relies_on is not None:
        return heard if topology.relies_on in heard else []
    return [robot for robot in heard if exchange.map_of(robot) is not None or whereabouts.position(robot) is not None]
