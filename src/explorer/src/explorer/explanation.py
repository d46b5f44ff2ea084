"""Why the robot drives where it drives, in words."""

from typing import List, Optional, Tuple

from explorer.clusters import Cluster
from explorer.driver import Goal
from explorer.messages import PAPER_UNIT
from explorer.scene import Scene
from explorer.status import State
from explorer.strategies.strategy import Bids, FrontierStrategy, Strategy


def reason_of(goal: Optional[Goal], state: State, strategy: Strategy, scene: Optional[Scene], heard: Bids) -> str:
    """Of a goal; empty without one. `heard`: bids of the others in the last auction."""
    if goal is None:
        return ""
    if goal.frontier is None:
        return "the way home" if state == State.RETURNING else "a closer look at frontiers that no reachable place sees"
    cluster = None if scene is None else scene.cluster(goal.cluster)
    if isinstance(strategy, FrontierStrategy) or scene is None or cluster is None:
        return strategy.title
    return f"{_among_own(scene, cluster, strategy)}{_among_others(cluster, heard, strategy)}"


def _among_own(scene: Scene, cluster: Cluster, strategy: Strategy) -> str:
    """How the cluster's bid compares with those for the other clusters that are free."""
    own = strategy.bid(scene, cluster)
    free = [each for each in scene.open if each.number not in scene.claimed and each.number != cluster.number]
    less = sum(strategy.bid(scene, each) < own for each in free)
    count = len(free) + 1
    if not free:
        among = "the only cluster left to it"
    elif not less:
        among = f"the lowest of {count} clusters"
    else:
        among = f"{less} of {count} clusters {'is' if less == 1 else 'are'} cheaper"
    return f"bid {_amount(own, strategy)}, {among}"


def _among_others(cluster: Cluster, heard: Bids, strategy: Strategy) -> str:
    bids: List[Tuple[float, str]] = sorted(
        (offers[cluster.number], robot) for robot, offers in heard.items() if cluster.number in offers
    )
    return f"; {bids[0][1]} bids {_amount(bids[0][0], strategy)}" if bids else ""


def _amount(bid: float, strategy: Strategy) -> str:
    return f"{bid:.1f} {'m^2' if strategy.unit == PAPER_UNIT else 'm'}"
