"""What clusters cost the other robots: by the bids that they have told, else by where they are."""

from typing import List, Tuple

import numpy as np

from explorer.assignment import cost_matrix
from explorer.scene import Scene
from explorer.strategies.strategy import Bids, Strategy


def costs_of_others(
    scene: Scene, bids: Bids, strategy: Strategy, estimate_unknown: bool = True
) -> Tuple[List[str], np.ndarray]:
    """The other robots that may take a cluster, and (clusters, robots) what the open clusters cost them; infinite where
    a robot cannot go there. Without `estimate_unknown` a robot that has answered without a bid for a cluster does not
    know it and will not go there, however near it is: nobody may be left empty-handed for its sake."""
    clusters = scene.open
    robots = [robot for robot in scene.competitors if robot not in bids or bids[robot]]
    rows = {cluster.number: row for row, cluster in enumerate(clusters)}
    told = {
        robot: {rows[number]: bid for number, bid in offered.items() if number in rows}
        for robot, offered in bids.items()
    }
    places = scene.positions
    if not estimate_unknown:
        places = {robot: place for robot, place in places.items() if robot not in bids}
    costs = cost_matrix(
        len(clusters), robots, told, places, lambda place, row: strategy.estimate(scene, place, clusters[row])
    )
    keep = [column for column in range(len(robots)) if np.isfinite(costs[:, column]).any()]
    return [robots[column] for column in keep], costs[:, keep]
