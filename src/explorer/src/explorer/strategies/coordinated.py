"""Strategy 7, the best there is: clusters are shared out among the robots, and shared out anew while driving."""

import math
from typing import Dict, Optional, Sequence, Tuple

import numpy as np

from explorer.assignment import assigned
from explorer.clusters import Cluster
from explorer.geometry import Position, distance, turn
from explorer.plan import Between, LastPlan, Plan, ways_between
from explorer.scene import Scene
from explorer.strategies.others import costs_of_others
from explorer.strategies.strategy import Allocation, Bids, ClusterStrategy, registered
from explorer.tour import MAXIMUM_STOPS, tour_lengths
from explorer.ways import Ways, place_near

# Smaller teams assign one cluster to each robot. Measured on the office (seeds 2601 to 2604, 2701 to 2703) and on
# generated floors (2611 to 2615): sharing out takes 7 % longer with two robots, as long with four, and a quarter less
# with eight.
FEWEST_SHARING = 5

# Weights, tuned on the office floor (26 m x 15 m) with perfect maps.
GAIN_WEIGHT = 0.1  # m of way that a square metre of unknown area is worth
GAIN_LIMIT = 8.0  # m^2 beyond which more unknown area makes no difference
TURN_WEIGHT = 0.4  # m of way per rad of turning before the start
TOUR_WEIGHT = 1.0  # m of way that a metre of detour in the tour through all clusters is worth
OFFSET = 2.0  # m, keeps bids positive (a negative bid means none)
LOYALTY = 2.0  # m in favour of the cluster that a robot explores already
CROWD_DISTANCE = 4.0  # m, a cluster this near to another robot's costs more
CROWD_PENALTY = 4.0  # m

MOST_ESTIMATES = 10_000  # that are kept

PARTING_DISTANCE = 5.0  # m from the start within which robots that cannot place each other part
PARTING_WAY = 12.0  # m that a cluster may be farther than the nearest to be taken for its direction


@registered
class Coordinated(ClusterStrategy):
    number = 7
    name = "coordinated"
    title = "auction by travel cost, clusters shared out among all robots, continuous reassignment (the best there is)"
    allocation = Allocation.CONTINUOUS
    unit = 7

    def __init__(self, random: np.random.Generator) -> None:
        super().__init__(random)
        self._planned: Sequence[Cluster] = ()
        self._between = Between({}, np.zeros((0, 0)))
        self._detours: Dict[int, float] = {}
        self._last_plan = LastPlan()
        self._estimated: Tuple[Sequence[Cluster], Optional[Ways], bool] = ((), None, False)
        self._estimates: Dict[Tuple[Position, int], float] = {}
        self._lengths: Dict[Tuple[Position, int], float] = {}  # of paths in metres, from places that stand for many

    def bid(self, scene: Scene, cluster: Cluster) -> float:
        x, y = cluster.place
        angle = 0.0
        if distance(scene.place, (x, y)) > 0.3:
            angle = turn(scene.pose.yaw, math.atan2(y - scene.pose.y, x - scene.pose.x))
        if sharing(scene):
            return way_bid(cluster.cost, angle)
        self._measure(scene)
        return travel_bid(cluster.cost, cluster.gain, angle, self._detours.get(cluster.number, 0.0))

    def estimate(self, scene: Scene, position: Position, cluster: Cluster) -> float:
        before, now = self._estimated, (scene.clusters, scene.ways, sharing(scene))
        same = before[0] is now[0] and before[1] is now[1] and before[2] == now[2]
        if not same or len(self._estimates) >= MOST_ESTIMATES:
            self._estimated, self._estimates, self._lengths = now, {}, {}
        asked = (position, cluster.number)
        if asked not in self._estimates:
            self._estimates[asked] = self._estimate(scene, position, cluster)
        return self._estimates[asked]

    def _estimate(self, scene: Scene, position: Position, cluster: Cluster) -> float:
        asked = (place_near(position), cluster.number)
        if asked not in self._lengths:
            self._lengths[asked] = scene.ways.from_robot(position).at(*cluster.place)
        length = self._lengths[asked]
        if not math.isfinite(length):
            length = 2.0 * distance(position, cluster.place)
        return way_bid(length) if sharing(scene) else travel_bid(length, cluster.gain)

    def choose(self, scene: Scene, bids: Bids) -> Optional[Cluster]:
        if must_part(scene):
            return by_rank(scene)
        robots, costs = costs_of_others(scene, bids, self, estimate_unknown=False)
        own = np.array([self.bid(scene, cluster) for cluster in scene.open], dtype=float)
        if not sharing(scene):
            return assigned_to(scene, own, robots, costs)
        self._measure(scene)
        shares = self._last_plan.shared_out(scene, own, robots, costs, self._between)
        return shares.own[0] if shares.own else help_of(shares, scene)

    def _measure(self, scene: Scene) -> None:
        """What depends on the clusters alone."""
        if scene.clusters is not self._planned:
            self._planned, self._between = scene.clusters, ways_between(scene)
            self._detours = {} if sharing(scene) else detours(scene, self._between)


def sharing(scene: Scene) -> bool:
    """True if the team is large enough; members that explore nothing now count, so that all bid alike at all times."""
    return max(len(scene.team), len(scene.competitors)) + 1 >= FEWEST_SHARING


def must_part(scene: Scene) -> bool:
    """True while robots that hear each other, and have started together, cannot tell who is where."""
    return bool(scene.team) and not scene.positions and distance(scene.place, scene.start) <= PARTING_DISTANCE


def by_rank(scene: Scene) -> Optional[Cluster]:
    """The cluster in the direction of this robot's rank among the names heard, kept until it is empty. Robots that have
    started together see the same clusters around the same place, so that each takes another."""
    if scene.current is not None or not scene.open:
        return scene.current
    farthest = min(cluster.cost for cluster in scene.open) + PARTING_WAY
    near = [cluster for cluster in scene.open if cluster.cost <= farthest]
    x, y = scene.start
    near.sort(key=lambda cluster: (math.atan2(cluster.centre[1] - y, cluster.centre[0] - x), cluster.number))
    team = sorted({*scene.team, scene.name})
    return near[team.index(scene.name) * len(near) // len(team)]


def way_bid(path_length: float, turn: float = 0.0) -> float:
    """Bid in metres: the way to the cluster and the turn to start it (rad)."""
    return path_length + TURN_WEIGHT * abs(turn)


def travel_bid(path_length: float, gain: float, turn: float = 0.0, detour: float = 0.0) -> float:
    """Bid in metres: the way to the cluster, the turn to start it (rad) and the detour that it makes of the tour
    through all clusters, less the worth of what is unknown there (m^2)."""
    bid = OFFSET + path_length + TURN_WEIGHT * abs(turn) + TOUR_WEIGHT * detour
    return max(0.0, bid - GAIN_WEIGHT * min(gain, GAIN_LIMIT))


def detours(scene: Scene, between: Between) -> Dict[int, float]:
    """{cluster number: how much longer in metres the tour through the nearest clusters gets if it starts there}."""
    stops = sorted(scene.candidates, key=lambda cluster: (cluster.cost, cluster.number))
    if len(stops) < 2:
        return {}
    near = stops[:MAXIMUM_STOPS]
    lengths = tour_lengths(np.array([cluster.cost for cluster in near]), between.of(near))
    longer = {cluster.number: float(length - lengths.min()) for cluster, length in zip(near, lengths)}
    for cluster in stops[MAXIMUM_STOPS:]:
        longer[cluster.number] = float(lengths.max() - lengths.min())
    return longer


def assigned_to(scene: Scene, own: np.ndarray, robots: Sequence[str], costs: np.ndarray) -> Optional[Cluster]:
    """One cluster for each robot, at the least sum of the costs."""
    own = own + np.array([crowd_penalty(scene, cluster) for cluster in scene.open])
    for row, cluster in enumerate(scene.open):
        holder = scene.claimed.get(cluster.number)
        if holder in robots:
            costs[row, robots.index(holder)] -= 2 * LOYALTY
        elif holder is not None:
            own[row] = math.inf
        if cluster.number == scene.own:
            own[row] -= LOYALTY
    share = assigned(costs, own)
    return None if share is None else scene.open[share]


def help_of(shares: Plan, scene: Scene) -> Optional[Cluster]:
    """For a robot without a share: the own cluster, else the one that it reaches the longest before the robot that is
    to explore it later."""
    helps = shares.helps()
    mine = [cluster for _, cluster in helps if cluster.number == scene.own]
    if mine or not helps:
        return mine[0] if mine else None
    return max(helps, key=lambda each: (each[0], -each[1].number))[1]


def crowd_penalty(scene: Scene, cluster: Cluster) -> float:
    """Metres that a cluster costs more because places that others have claimed are near to it. A claim on the cluster
    itself is no place nearby: the holder's cost tells what it is worth."""
    penalty, holder = 0.0, scene.claimed.get(cluster.number)
    for robot, claim in scene.claims.items():
        if robot != holder and len(claim.places):
            gaps = np.hypot(*(cluster.points[:, None, :] - claim.places[None, :, :]).transpose(2, 0, 1))
            penalty = max(penalty, CROWD_PENALTY * max(0.0, 1.0 - float(gaps.min()) / CROWD_DISTANCE))
    return penalty
