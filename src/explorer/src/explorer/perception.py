"""From maps to clusters: frontiers, where the robot can go, and from where it looks at what."""

import math
from typing import Dict, List, Optional, Sequence, Tuple

import numpy as np

from explorer._kernels import near_any
from explorer.clusters import Cluster, ClusterStore
from explorer.frontier_map import FrontierMap
from explorer.frontiers import Frontier, FrontierStore, points_of
from explorer.geometry import Position, distance
from explorer.grid import OccupancyMap
from explorer.leftovers import Left, leftovers
from explorer.narrow import SlimmerRobot
from explorer.options import Options
from explorer.prospects import Prospect, prospects
from explorer.senses import Senses
from explorer.travel import CostField
from explorer.verdicts import Verdicts
from explorer.views import Views, sees
from explorer.ways import Ways, known_near
from explorer.worth import (
    TOLD_DISTANCE,
    Worth,
    is_opening,
    too_much_to_leave,
    without_denied,
    without_detours,
    worth_of,
)
from mr_grid import Pose

REPLAN_PERIOD = 1.0  # s between two looks at the costs while the robot moves
REPLAN_DISTANCE = 0.3  # m of motion that makes them old
BLOCK_AHEAD = 0.6  # m, as near as the middle of a robot comes to the middle of what blocks its way
BLOCK_RADIUS = 0.4  # m around it that other ways are blocked as well


class Perception:
    """Works anew when there is a new map, when the robot has moved on, or when verdicts have changed."""

    def __init__(self, options: Options, senses: Senses) -> None:
        self._options = options
        self._senses = senses
        first = options.robot_number * 10000
        self.frontiers = FrontierStore(first_number=first if options.simulation else 0)
        self._clusters = ClusterStore(first_number=first)
        self.clusters: Tuple[Cluster, ...] = ()
        self.ways: Optional[Ways] = None
        self.revision = 0  # counts what was perceived
        self.restart()

    def restart(self) -> None:
        """Forgets all frontiers; numbers are not given again."""
        self.frontiers.clear()
        self.clusters = ()
        self.worth = Worth({}, {}, frozenset())
        self._goal_points = points_of(())  # of all goals, before ways are looked at
        self._prospects: Dict[int, Prospect] = {}
        self._frontier_map: Optional[FrontierMap] = None
        self.field: Optional[CostField] = None
        self._views: Optional[Views] = None
        self._slimmer: Optional[SlimmerRobot] = None
        self._explained: Optional[Worth] = None
        self._new_map = self._stale = False
        self._place: Position = (math.inf, math.inf)
        self._time = -math.inf

    def begin_frame(self) -> None:
        """Forgets everything: the map frame is another one."""
        self.restart()
        self.ways = None

    def take_map(self) -> None:
        """There is a new map."""
        self._new_map = True

    def touch(self) -> None:
        """Verdicts or what is known of the other robots have changed."""
        self._stale = True

    def take_explored(self, places: Sequence[Position]) -> None:
        """Others have explored these places, in metres: the goals are others if one of them is beside a place."""
        if places and near_any(np.array(places), self._goal_points, TOLD_DISTANCE).any():
            self.touch()

    def update(self, verdicts: Verdicts, others: Sequence[Position], team: int, now: float) -> List[Frontier]:
        """Perceives if that is due; the frontiers that are gone. `others`: places of the other robots in metres;
        `team`: number of those that are there."""
        occupancy, pose = self._senses.map, self._senses.pose
        assert occupancy is not None and pose is not None
        if self._senses.rests(now):
            self._stale = verdicts.judge_looked(now, self.known_near, self.known_area_near) or self._stale
        if not (self._new_map or self._stale or self._due(pose, verdicts, now)):
            return []
        gone: List[Frontier] = []
        if self._new_map:
            radius, largest = self._options.inflation_radius, self._options.largest_robot_radius
            ways = Ways(occupancy, radius, others, largest, team, self.ways)
            gone = self._read(occupancy, verdicts, ways, now)
        assert self.ways is not None
        self.field = self.ways.grid.field_from(pose.x, pose.y, self.field)
        self._views = Views(occupancy, self.field, self._options.view_distance, self._views)
        self._place, self._time = (pose.x, pose.y), now
        self._new_map = self._stale = False
        self._assess(verdicts, now)
        return gone

    def known_near(self, x: float, y: float) -> int:
        """Number of known cells of the newest map within a metre of a point."""
        assert self._senses.map is not None
        return known_near(self._senses.map, x, y)

    def known_area_near(self, x: float, y: float) -> float:
        """m^2 of the newest map that are known within a metre of a point."""
        assert self._senses.map is not None
        return self.known_near(x, y) * self._senses.map.info.resolution**2

    def is_opening(self, cluster: Cluster) -> bool:
        """True if the robot might come to stand in what is unknown behind a cluster."""
        return is_opening([self._prospects[number] for number in cluster.views])

    def in_view(self, pose: Pose, point: Position) -> bool:
        """True if the robot at that pose sees a point near to it, both in metres."""
        assert self.ways is not None
        if distance(point, (pose.x, pose.y)) > self._options.view_distance + 0.5:
            return False
        occupied, info = self.ways.grid.occupied, self.ways.occupancy.info
        return sees(occupied, info, pose, self._options.field_of_view, point)

    def way(self, here: Pose, place: Pose) -> float:
        """m of path between two places, infinite where none leads."""
        assert self.ways is not None
        return self.ways.grid.field_from(here.x, here.y).at(place.x, place.y)

    def rest_of_way(self, place: Pose) -> float:
        """m of path from where the robot was when it last perceived."""
        assert self.field is not None
        return self.field.at(place.x, place.y)

    def behind_block(self, near: Position, place: Pose) -> List[int]:
        """Numbers of the points in sight of places to which the way from `near` leads through what blocks that to
        `place`, which is not on the map: something just ahead on the way, where that is narrow; else none."""
        assert self.ways is not None
        field = self.ways.grid.field_from(*near)
        block = next((p for p in field.path_to(place.x, place.y) if distance(near, p) >= BLOCK_AHEAD), None)
        if block is None or self.ways.grid.clearance_at(*block) >= self.ways.comfort:
            return []
        views = {number: view for cluster in self.clusters for number, view in cluster.views.items()}
        return [n for n, (x, y, _) in views.items() if _passes(field.path_to(x, y), block)]

    def leftovers(self) -> Tuple[Left, ...]:
        """What would be left unexplored if this were the end, the largest first."""
        return leftovers(self.clusters, self.explained(), self._prospects)

    def explained(self) -> Worth:
        """As `worth`, with a reason also for points that are seen from nowhere because a way is too narrow."""
        if self._explained is None:
            self._explained = self.worth._replace(reasons={**self._too_narrow(), **self.worth.reasons})
        return self._explained

    def _too_narrow(self) -> Dict[int, str]:
        """{number: reason} of the points that no reachable place sees."""
        unseen = [
            member
            for cluster in self.clusters
            for member in cluster.members
            if member.number not in cluster.views and member.number not in self.worth.reasons
        ]
        if not unseen or self.ways is None or self.field is None:
            return {}
        reach, former = self._options.view_distance, self._slimmer
        self._slimmer = SlimmerRobot(self.ways, self.field, self._place, reach, former)
        return self._slimmer.reasons(unseen)

    def unreachable(self, verdicts: Verdicts) -> int:
        """Frontiers that are given up, or that no reachable place sees."""
        seen = {number for cluster in self.clusters for number in cluster.views}
        marks = [(number, verdicts.of(number)) for number in self.frontiers.frontiers]
        return sum(mark.given_up or (not mark.visited and number not in seen) for number, mark in marks)

    def _due(self, pose: Pose, verdicts: Verdicts, now: float) -> bool:
        if now - self._time < REPLAN_PERIOD:
            return False
        return distance((pose.x, pose.y), self._place) > REPLAN_DISTANCE or verdicts.told_expired(now)

    def _read(self, occupancy: OccupancyMap, verdicts: Verdicts, ways: Ways, now: float) -> List[Frontier]:
        pose = self._senses.pose
        assert pose is not None
        frontier_map = FrontierMap.of(occupancy, self._frontier_map)
        same = self.ways is not None and self.ways.grid is ways.grid and self._frontier_map is frontier_map
        self.ways, self._frontier_map = ways, frontier_map
        gone = [] if same else self._find_frontiers(occupancy, frontier_map, verdicts)
        shown = now if self._senses.rests(now) else self._senses.shown
        verdicts.judge_looked(shown, self.known_near, self.known_area_near)
        verdicts.revive_changed(self.known_near)
        if not same:
            self._clusters.update(self.frontiers.ordered(), occupancy)
        self._prospects = prospects(self.frontiers.ordered(), ways, (pose.x, pose.y))
        verdicts.follow_clusters(cluster.number for cluster in self._clusters.clusters)
        return gone

    def _find_frontiers(self, occupancy: OccupancyMap, frontier_map: FrontierMap, verdicts: Verdicts) -> List[Frontier]:
        """Those that are gone."""
        cells = frontier_map.of_length(self._options.minimal_frontier_length)
        new, gone = self.frontiers.update(occupancy, cells)
        verdicts.follow(new, gone)
        return gone

    def _assess(self, verdicts: Verdicts, now: float) -> None:
        assert self._views is not None
        worth = worth_of(self._clusters.clusters, self._prospects, verdicts, self.known_area_near, now)
        self._goal_points = points_of(worth.goals.values())
        clusters = self._views.assess(self._clusters.clusters, worth.goals)
        self.clusters, self.worth = without_detours(clusters, worth, self._prospects)
        self._deny(verdicts)
        if not any(cluster.reachable for cluster in self.clusters) and not self._settled(verdicts):
            self._take_up_leftovers()
        self._explained = None
        self.revision += 1

    def _settled(self, verdicts: Verdicts) -> bool:
        """The team has come to the end, and leaves little enough."""
        assert self._senses.map is not None
        return bool(verdicts.heard.witnesses) and verdicts.heard.settled(self._senses.map.known_area)

    def _deny(self, verdicts: Verdicts) -> None:
        assert self._senses.map is not None
        self.clusters, self.worth = without_denied(
            self.clusters, self.worth, self._prospects, verdicts.heard, self._senses.map
        )

    def _take_up_leftovers(self) -> None:
        """Nothing else is left: of what was dropped as too little, the largest pieces, if they are much together."""
        assert self._views is not None and self._senses.map is not None
        occupancy = self._senses.map
        free_area = np.count_nonzero(occupancy.free) * occupancy.info.resolution**2
        goals = too_much_to_leave(self.clusters, self.worth, self._prospects, free_area)
        if goals:
            reasons = {number: reason for number, reason in self.worth.reasons.items() if number not in goals}
            self.worth = self.worth._replace(goals={**self.worth.goals, **goals}, reasons=reasons)
            self.clusters = self._views.assess(self._clusters.clusters, self.worth.goals)


def _passes(path: Sequence[Position], place: Position) -> bool:
    return any(distance(point, place) <= BLOCK_RADIUS for point in path)
