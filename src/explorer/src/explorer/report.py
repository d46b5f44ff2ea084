"""What a robot explores and why, as one value."""

import math
from dataclasses import dataclass
from typing import Dict, List, Mapping, Optional, Tuple

import numpy as np

from explorer.auction_result import AuctionResult
from explorer.explanation import reason_of
from explorer.exploration import Exploration
from explorer.forecast import rest_of
from explorer.geometry import Position
from explorer.grid import OccupancyMap
from explorer.leftovers import reasons
from explorer.limits import Limits
from explorer.perception import Perception
from explorer.scene import Scene
from explorer.statement import Stage
from explorer.status import Status

MOST_LEFT = 100


@dataclass(frozen=True)
class Left:
    """Frontier points that are no goals: their middle and the diagonal of their box in m, and the reason."""

    place: Position
    points: int
    size: float
    reason: str


@dataclass(frozen=True)
class Report:
    """`ended_by`: how the exploration ended, empty while it has not. `reason`: why the robot drives to its goal.
    `bids`: {robot: bid for its cluster}, and `auction`, the last one that it has held, in `unit`. `assignment`: {robot:
    place in m of its cluster}. `area`: known, in m^2. `rest`: expected, in s, NaN while unknown. `team`: {robot that
    the radio reaches: what it has said last of the end}; None for robots that say nothing of it and still explore.
    `limits`: of the exploration."""

    status: Status
    paused: bool
    ended_by: str
    reason: str
    strategy: str
    unit: int
    bids: Mapping[str, float]
    auction: Optional[AuctionResult]
    assignment: Mapping[str, Position]
    area: float
    rest: float
    left: Tuple[Left, ...]
    team: Mapping[str, Optional[Stage]]
    limits: Limits


def report_of(
    status: Status, mission: Exploration, perception: Perception, occupancy: Optional[OccupancyMap], now: float
) -> Report:
    scene, strategy = mission.scene(now), mission.strategy
    heard = mission.auctions.heard
    return Report(
        status=status,
        paused=mission.orders.paused,
        ended_by=mission.orders.ended_by or "",
        reason=reason_of(mission.driver.goal, status.state, strategy, scene, heard),
        strategy=strategy.name,
        unit=strategy.unit,
        bids={} if scene is None else _bids(status.robot, mission, scene),
        auction=mission.last_auction,
        assignment={} if scene is None else _assignment(status.robot, scene),
        area=0.0 if occupancy is None else occupancy.known_area,
        rest=_rest(mission, scene, status),
        left=tuple(_left(perception, reasons(perception.clusters, perception.explained()))),
        team={robot: _stage(mission, robot) for robot in mission.team.known()},
        limits=mission.orders.limits,
    )


def _stage(mission: Exploration, robot: str) -> Optional[Stage]:
    """As it has said; of a robot that says nothing, because it does not know how, its answers to auctions tell."""
    said = mission.agreement.stage(robot)
    return Stage.ENDED if said is None and mission.team.rests(robot) else said


def _rest(mission: Exploration, scene: Optional[Scene], status: Status) -> float:
    if status.finished:
        return 0.0
    if scene is None:
        return math.nan
    return rest_of(scene, status.counters.distance, status.exploration_time)[2]


def _bids(own_name: str, mission: Exploration, scene: Scene) -> Dict[str, float]:
    """For the own cluster: the own one as it is now, those of the others in the last auction."""
    own = scene.current
    if own is None:
        return {}
    heard = {robot: offers[own.number] for robot, offers in mission.auctions.heard.items() if own.number in offers}
    return {own_name: mission.strategy.bid(scene, own), **heard}


def _assignment(own_name: str, scene: Scene) -> Dict[str, Position]:
    """Places of clusters by robot; of a claim on own points it is their middle."""
    points = {member.number: (member.x, member.y) for cluster in scene.clusters for member in cluster.members}
    found: Dict[str, Position] = {}
    own = scene.cluster(scene.own)
    if own is not None:
        found[own_name] = own.place
    for robot, claim in scene.claims.items():
        places = [*claim.places.tolist(), *(points[number] for number in sorted(claim.own) if number in points)]
        if places:
            x, y = np.mean(places, axis=0).tolist()
            found[robot] = (x, y)
    return found


def _left(perception: Perception, why: Mapping[int, str]) -> List[Left]:
    """By cluster and reason, the largest first."""
    groups: Dict[Tuple[int, str], List[Position]] = {}
    for cluster in perception.clusters:
        for member in cluster.members:
            if member.number in why:
                groups.setdefault((cluster.number, why[member.number]), []).append((member.x, member.y))
    left = []
    for (_, reason), places in groups.items():
        x, y = np.mean(places, axis=0).tolist()
        left.append(Left((x, y), len(places), float(np.hypot(*np.ptp(places, axis=0))), reason))
    return sorted(left, key=lambda each: (-each.points, each.place))[:MOST_LEFT]
