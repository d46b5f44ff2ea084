"""What of a run of the own map outlives the node, so that one that is started anew goes on with it.

The other robots name the run in their transforms. As long as it keeps its name their maps, transforms and graph hold,
and this robot is placed by what they tell. It ends with whatever makes the local map, whose frame is another one then.
"""

import math
from typing import Dict, Optional

from mr_grid import GridInfo, Pose

from .exchange import bounds
from .messages import Anchor

SKIPPED = bounds.MOST_REQUESTED + 50
"""Update numbers that may have been used since the run was kept; missing so many, the others ask for everything."""


def value_of(anchor: Anchor, source: str, teller: str = "") -> Dict[str, object]:
    """As a parameter. `source` names the process that makes the local map, `teller` the one that tells where the robot
    is in it, empty while none does."""
    info = anchor.info
    return {
        "robot": anchor.robot,
        "source": source,
        "teller": teller,
        "boot": [str(number) for number in anchor.boot],  # too large for XML-RPC
        "corner": [*info.origin, info.resolution],
        "updates": anchor.updates,
    }


def anchor_of(value: object, robot: str, source: str) -> Optional[Anchor]:
    """The run to go on with; None if nothing that can be used was kept, or not of this robot and source."""
    if not isinstance(value, dict):
        return None
    try:
        x, y, yaw, resolution = (float(number) for number in value["corner"])
        seconds, nanoseconds = (int(number) for number in value["boot"])
        updates = int(value["updates"])
        is_own = (value["robot"], value["source"]) == (robot, source)
    except (KeyError, OverflowError, TypeError, ValueError):
        return None
    usable = all(map(math.isfinite, (x, y, yaw))) and 0.0 < resolution < math.inf and updates >= 0
    if not source or not is_own or not usable:
        return None
    return Anchor(robot, GridInfo(0, 0, resolution, Pose(x, y, yaw)), (seconds, nanoseconds), updates + SKIPPED)


def teller_of(value: object) -> str:
    """Who told where the robot is in the map of the run that was kept; empty if nobody knows."""
    return str(value.get("teller", "")) if isinstance(value, dict) else ""
