"""How long the rest of the exploration takes."""

import math
from typing import Tuple

import numpy as np

from explorer.scene import Scene
from explorer.tour import MAXIMUM_STOPS, tour_lengths

SLOWEST = 0.01  # m/s, a robot on average slower than this has not driven enough to tell


def rest_of(scene: Scene, driven: float, time: float) -> Tuple[int, float, float]:
    """Number of the clusters that no other robot has claimed, the length in m of the shortest tour through them, and
    the time in s that it takes at the speed so far, of `driven` m in `time` s; NaN while that is not known. Of many
    clusters the nearest are ordered, the others take as much way as these on average."""
    stops = [cluster for cluster in scene.candidates if cluster.number not in scene.claimed]
    if not stops:
        return 0, 0.0, 0.0
    near = sorted(stops, key=lambda cluster: (cluster.cost, cluster.number))[:MAXIMUM_STOPS]
    ways = scene.ways.between([cluster.place for cluster in near])
    costs = np.array([cluster.cost for cluster in near])
    ways = np.where(np.isfinite(ways), ways, costs[:, None] + costs[None, :])
    length = float(tour_lengths(costs, np.minimum(ways, ways.T)).min()) * len(stops) / len(near)
    speed = driven / time if time > 0.0 else 0.0
    return len(stops), length, length / speed if speed >= SLOWEST else math.nan
