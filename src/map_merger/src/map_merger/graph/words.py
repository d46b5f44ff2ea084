"""Why an edge was dropped, for people."""

import math
from typing import List, Tuple

from ..transform import rotation_between
from .edges import Edge
from .pose_graph import Poses, transform_between


def contradiction(edge: Edge, poses: Poses, nodes: List[str], via: Tuple[str, ...]) -> str:
    """For example `contradicts robot_1 - robot_2 - robot_3 by 1.8 m, 4 deg`. via: between the edge's robots."""
    placed = transform_between(poses, nodes.index(edge.reporter), nodes.index(edge.target))
    distance = math.hypot(placed.x - edge.transform.x, placed.y - edge.transform.y)
    turn = math.degrees(rotation_between(placed, edge.transform))
    chain = " - ".join((edge.reporter, *via, edge.target) if via else (edge.target, edge.reporter))
    return f"contradicts {chain} by {distance:.1f} m, {turn:.0f} deg"
