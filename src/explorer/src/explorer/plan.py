"""Who goes where, as one robot sees it: all clusters shared out among all robots, each with a tour of its own."""

import math
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from explorer.clusters import Cluster
from explorer.scene import Scene
from explorer.shares import Errand, Tour, arrivals, share_out

MAXIMUM_CLUSTERS = 20  # the nearest, that are shared out
LONGEST_WAY = 1e6  # m, bids above are none

# Weights of strategy 7, tuned with four robots on the office floor
# (seeds 2601 to 2604) and generated floors (2611 to 2615).
SERVICE = 5.0  # m of way that a cluster costs by itself: what is found there has to be explored as well
SERVICE_PER_AREA = 0.2  # m for each m^2 of unknown area around it
GREATEST_AREA = 20.0  # m^2 that count
RIVAL_SHARE = 1.5  # times the own way, and
RIVAL_MARGIN = 2.0  # m more: a claim on a cluster does not hold if the way of who holds it is longer
LOYALTY_SHARE = 0.2  # of the way to the own cluster, and
LOYALTY = 1.0  # m, that the own cluster is taken for nearer


class Between(NamedTuple):
    """Ways in metres between clusters: `rows` {cluster number: row} of the symmetric array `ways`."""

    rows: Mapping[int, int]
    ways: np.ndarray

    def of(self, clusters: Sequence[Cluster]) -> np.ndarray:
        """(n, n) ways between n of the clusters."""
        rows = [self.rows[cluster.number] for cluster in clusters]
        return self.ways[np.ix_(rows, rows)]


def ways_between(scene: Scene) -> Between:
    """Between the nearest clusters of a scene; where no path is known, twice the way to them."""
    near = sorted(scene.candidates, key=lambda cluster: (cluster.cost, cluster.number))[:MAXIMUM_CLUSTERS]
    ways = scene.ways.between([cluster.place for cluster in near])
    ways = np.where(np.isfinite(ways), ways, 2.0 * np.array([[cluster.cost for cluster in near]]))
    return Between({cluster.number: row for row, cluster in enumerate(near)}, np.minimum(ways, ways.T))


class Plan(NamedTuple):
    """`clusters` as they were shared out, and the `tours` of all robots, this one's first, as indices of them."""

    clusters: Sequence[Cluster]
    errand: Errand
    tours: List[Tour]

    @property
    def own(self) -> List[Cluster]:
        """This robot's share, in the order of its tour."""
        return [self.clusters[stop] for stop in self.tours[0]]

    def helps(self) -> List[Tuple[float, Cluster]]:
        """What other robots are to go to later, not next: how many metres before them this one is there, and the
        cluster."""
        return [
            (there - float(self.errand.starts[0, stop]), self.clusters[stop])
            for robot in range(1, len(self.tours))
            for stop, there in arrivals(self.errand, robot, self.tours[robot])[1:]
        ]


def shared_out(scene: Scene, own: np.ndarray, robots: Sequence[str], others: np.ndarray, between: Between) -> Plan:
    """Shares the open clusters out. `own`: (clusters,) what they cost this robot in metres; `others`: (clusters,
    robots) what they cost the other `robots`, infinite where one cannot go. What is claimed by a robot of which that
    is not known is left to it."""
    rows = _rows(scene, robots, others, between)
    clusters = [scene.open[row] for row in rows]
    starts = np.vstack([_loyal(own[rows], clusters, scene.own)[None, :], others[rows].T])
    starts[~(starts < LONGEST_WAY)] = math.inf
    claims: Dict[Optional[str], int] = {}
    for stop, each in enumerate(clusters):
        claims.setdefault(scene.claimed.get(each.number), stop)
    held = [_held(own[rows], starts[index], claims.get(robot)) for index, robot in enumerate(robots, start=1)]
    service = np.array([SERVICE + SERVICE_PER_AREA * min(cluster.gain, GREATEST_AREA) for cluster in clusters])
    errand = Errand(starts, between.of(clusters), service, [None, *held])
    return Plan(clusters, errand, share_out(errand))


class LastPlan:
    """What `shared_out` gave last, and for what: a robot without a share asks at every step, mostly the same."""

    def __init__(self) -> None:
        self._clusters: Sequence[Cluster] = ()
        self._between: Optional[Between] = None
        self._asked: Tuple[object, ...] = ()
        self._plan: Optional[Plan] = None

    def shared_out(
        self, scene: Scene, own: np.ndarray, robots: Sequence[str], others: np.ndarray, between: Between
    ) -> Plan:
        """As the function."""
        asked = ([each.number for each in scene.open], scene.claimed, scene.own, own.tobytes(), [*robots],
                 others.tobytes())  # fmt: skip
        same = self._clusters is scene.clusters and self._between is between and self._asked == asked
        if self._plan is None or not same:
            self._clusters, self._between, self._asked = scene.clusters, between, asked
            self._plan = shared_out(scene, own, robots, others, between)
        return self._plan


def _rows(scene: Scene, robots: Sequence[str], others: np.ndarray, between: Between) -> List[int]:
    """Of the open clusters that are shared out."""
    columns = {robot: column for column, robot in enumerate(robots)}
    rows = []
    for row, cluster in enumerate(scene.open):
        holder = scene.claimed.get(cluster.number)
        placed = holder is None or (holder in columns and others[row, columns[holder]] < LONGEST_WAY)
        if placed and cluster.number in between.rows:
            rows.append(row)
    return rows


def _loyal(own: np.ndarray, clusters: Sequence[Cluster], current: Optional[int]) -> np.ndarray:
    nearer = np.maximum(0.0, (1.0 - LOYALTY_SHARE) * own - LOYALTY)
    return np.where([cluster.number == current for cluster in clusters], nearer, own)


def _held(own: np.ndarray, theirs: np.ndarray, row: Optional[int]) -> Optional[int]:
    """A claimed row, if the claim holds against this robot."""
    if row is None:
        return None
    return row if theirs[row] <= RIVAL_SHARE * own[row] + RIVAL_MARGIN else None
