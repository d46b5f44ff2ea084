"""When the nodes of a team come up before its mission begins, as roslaunch on a robot's computer brings them up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

# s, least and most of what missions of the ROS stack took; uniform between.
SENSING = (0.2, 2.2)  # from switching on to the first scan in SLAM
NODES = (1.0, 4.0)  # from there to map_merger and explorer
ORDER = (0.3, 1.5)  # from the moment when all robots are ready to the order to explore
STREAM = 1  # keeps these numbers apart from others drawn from a trial's seed


@dataclass(frozen=True)
class StartUp:
    """Of one team. Without it, timers of all nodes and robots would tick in step with the mission's start."""

    sensing: tuple[float, ...]  # s, when each robot's SLAM starts
    nodes: tuple[float, ...]  # s, when its map_merger and explorer start
    order: float  # s between the last robot's readiness and the start of the mission

    @classmethod
    def of_team(cls, robots: int, seed: int) -> StartUp:
        generator = np.random.default_rng((seed, STREAM))
        sensing = generator.uniform(*SENSING, robots)
        nodes = sensing + generator.uniform(*NODES, robots)
        return cls(tuple(sensing.tolist()), tuple(nodes.tolist()), float(generator.uniform(*ORDER)))
