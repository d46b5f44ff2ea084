"""The explorer of one robot: maps, poses and messages in; goals, messages and logs out.

No clock, no ROS, no thread: every call takes `now` in seconds, `tick` returns the effects. State machine:

    STARTING  until started, with map, pose         -> EXPLORING
    EXPLORING chooses or drives to a frontier       -> WAITING, RETURNING
    WAITING   frontiers are left, none for this robot now, or it is checked whether really none is left
    RETURNING finished, drives home                 -> FINISHED
    FINISHED  at rest
"""

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import Dict, List, Mapping, Optional, Sequence, Set, Tuple

import numpy as np

from explorer import choice, logs
from explorer._kernels import near_any
from explorer.assignment import cost_matrix, squared_euclidean
from explorer.auction import OpenAuction, closing_message, elements_of, first_auction_id, reply_message
from explorer.clusters import Cluster, ClusterStore, Listed, match, places_of
from explorer.frontiers import Element, ForeignFrontiers, Frontier, FrontierStore, Key, frontier_cells
from explorer.grid import FARTHEST, OccupancyMap, is_place
from explorer.messages import (
    FAILED,
    REACHED,
    AskTransform,
    Auction,
    Bid,
    CancelGoal,
    Effect,
    LogOutput,
    Note,
    Pose,
    SendAuction,
    SendFrontiers,
    SetGoal,
    WriteLog,
)
from explorer.options import Options
from explorer.team import Team
from explorer.tour import MAXIMUM_STOPS, tour_lengths, ways_between
from explorer.travel import CostField, TravelGrid
from explorer.views import Views, sees

COORDINATED = (1, 7)
NEGOTIATED = (5, 6)

REPLAN_PERIOD = 1.0  # s between two looks at the costs while the robot moves
REPLAN_DISTANCE = 0.3  # m of motion that makes them old
SHARE_PERIOD = 1.5  # s between two messages with frontiers
REFRESH_PERIOD = 30.0  # s after which all own frontiers are sent again
CONFIRM_PERIOD = 8.0  # s after which a claim is confirmed
REASSIGN_PERIOD = 5.0  # s between two auctions while the robot drives (strategy 7)
PATIENCE = 4.0  # s after which a cluster that nobody claims is taken by a robot that has none
RETRY_PERIOD = 1.0  # s between two auctions while the robot waits
TRANSFORM_PERIOD = 5.0  # s after which a transform is asked for again
CLOCK_TOLERANCE = 1.0  # s by which the clock may be set back without consequences
LOG_PERIOD = 10.0  # s, contract 3.8
LOG_MAPS, LOG_MAPS_AT_END = 12, 3  # masks of map_merger's logOutput, contract 3.2
ARRIVED_DISTANCE = 0.45  # m, the goal is close enough to look
LOOK_TIME = 1.5  # s that the map needs to show what was looked at
TOLD_TIME = 8.0  # s that the merged map needs to show what another robot has explored
TOLD_DISTANCE = 0.5  # m, own frontiers this near to an explored point of another robot are no goals
NOTHING_TIME = 5.0  # s at rest after which a map that does not change counts as fresh
BLOCKING_DISTANCE = 1.5  # m, a robot this near may be what makes a goal fail
BLOCKED_TRIES = 3  # failures behind a robot that count as one: it may have come to stay
FEWEST_FIELDS = 8  # of other robots' costs that are kept, more in a larger team
TOUR_CELL = 0.2  # m, resolution at which ways between clusters are measured
WORTH_A_LOOK = 4  # frontier points without a viewpoint that are worth a closer look before the end
CLOSER_LOOKS = 20  # such looks in a mission
LOOKS = 2  # times a frontier is looked at before it counts as visited
REVIVALS = 3  # times a frontier that was given up is tried anew
GOAL_TRIES = 5  # times a goal is sent before it counts as failed because move_base does not accept it
HOME_ATTEMPTS = 5  # contract 3.3
HOME_DISTANCE = 0.4  # m


class State(IntEnum):
    """Values of `explorer/ExplorationState`."""

    STARTING = 0
    EXPLORING = 1
    WAITING = 2
    RETURNING = 3
    FINISHED = 4


@dataclass
class Goal:
    """What the robot drives to. `frontier` and `cluster` are numbers, None on the way home or to step aside."""

    goal_id: int
    pose: Pose
    sent: float
    frontier: Optional[int] = None
    cluster: Optional[int] = None
    accepted: bool = False
    progress_place: Tuple[float, float] = (0.0, 0.0)
    progress_time: float = 0.0


@dataclass
class Counters:
    goals: int = 0
    goals_reached: int = 0
    goals_failed: int = 0
    auctions_completed: int = 0
    auctions_uncompleted: int = 0
    maps: int = 0
    distance: float = 0.0


class ExplorerAgent:
    """See the module. Bounded in memory; every message from outside may be late, lost, doubled or out of order."""

    def __init__(self, options: Options) -> None:
        self.options = options
        self.name = options.robot_name
        self.home: Optional[Pose] = Pose(*options.home_pose) if options.home_pose else None
        first = options.robot_number * 10000 if options.simulation else 0
        self.frontiers = FrontierStore(first_number=first)
        self.clusters = ClusterStore(first_number=options.robot_number * 10000)
        self.foreign = ForeignFrontiers()
        self.pose: Optional[Pose] = None
        self.map: Optional[OccupancyMap] = None
        self.grid: Optional[TravelGrid] = None
        self.revision = 0
        self._random = np.random.default_rng(options.seed)
        self._outbox: List[Effect] = []
        self._complaints: Set[str] = set()
        self._ticked = -math.inf
        self._goal_counter = 0
        self._auction_counter = first_auction_id(self.name, options.robot_number, options.simulation)
        self._prepare()

    def _prepare(self) -> None:
        """All that belongs to one mission, with all times."""
        self.state = State.STARTING
        self.text = "waits for the start"
        self.counters = Counters()
        self.started_at: Optional[float] = None
        self.finished_at: Optional[float] = None
        self.team = Team(self.name, self.options.claim_timeout)
        self.goal: Optional[Goal] = None
        self._awaited_since = -math.inf  # since when move_base has accepted none of the goals sent
        self._auction: Optional[OpenAuction] = None
        self._foreign_auctions: Dict[str, float] = {}
        self._cluster: Optional[int] = None
        self._cluster_failures: Dict[int, int] = {}
        self._given_up_maps: Dict[int, Tuple[int, int]] = {}
        self._hidden_foreign: List[Tuple[float, float, float]] = []
        self._detours: Dict[int, float] = {}
        self._tour_stale = True
        self._other_fields: Dict[Tuple[float, float], CostField] = {}
        self._tour_grid: Optional[TravelGrid] = None
        self._field: Optional[CostField] = None
        self._views: Optional[Views] = None
        self._view_of: Dict[int, Tuple[float, float, float]] = {}
        self._map_changed = False
        self._dirty = False
        self._told_explored = False
        self._field_place: Tuple[float, float] = (math.inf, math.inf)
        self._field_time = -math.inf
        self._map_time = -math.inf
        self._own_map_time = -math.inf
        self._motion_time = -math.inf
        self._motion_pose: Optional[Pose] = None
        self._empty_since: Optional[float] = None
        self._sent: Set[int] = set()
        self._vanished: Dict[int, Frontier] = {}
        self._share_time = -math.inf
        self._refresh_time = -math.inf
        self._confirm_time = -math.inf
        self._claimed: Tuple[Key, ...] = ()
        self._auction_time = -math.inf
        self._idle_since: Optional[float] = None
        self._closer_looks: Dict[Tuple[int, int], int] = {}
        self._transform_times: Dict[str, float] = {}
        self._log_time = -math.inf
        self._home_attempts = 0
        self._hold_until = -math.inf

    # ---- input ----------------------------------------------------------------------------------------------------

    def start(self, now: float) -> bool:
        """Starts the mission; False if it was started before."""
        if self.started_at is not None:
            return False
        self.started_at = now
        self._log_time = now
        return True

    def on_global_map(self, occupancy: OccupancyMap, now: float) -> None:
        self.map = occupancy
        self._map_changed = True
        self._map_time = now
        self.counters.maps += 1

    def on_own_map(self, now: float) -> None:
        """The robot's own SLAM has updated its map."""
        self._own_map_time = now

    def on_pose(self, pose: Pose, now: float) -> None:
        """Pose of the robot in its map frame."""
        if not is_place(pose.x, pose.y, pose.yaw):
            self._complain("poses", f"({pose.x:g}, {pose.y:g}, {pose.yaw:g}): check tf")
            return
        if self.pose is not None:
            step = math.hypot(pose.x - self.pose.x, pose.y - self.pose.y)
            self.counters.distance += step if step > 0.005 else 0.0
        self.pose = pose
        if self.home is None:
            self.home = pose
        anchor = self._motion_pose
        if anchor is None or _apart(anchor, pose) > 0.05 or abs(_turn(anchor.yaw, pose.yaw)) > 0.1:
            self._motion_pose, self._motion_time = pose, now

    def on_positions(self, positions: Mapping[str, Tuple[float, float]], now: float) -> None:
        """Positions of other robots in metres in the own map frame (map_merger's `all_positions`)."""
        usable = {name: place for name, place in positions.items() if is_place(*place)}
        strange = sorted(set(positions) - set(usable))
        if strange:
            self._complain("positions", f"of {', '.join(strange[:5])}: check map_merger there")
        self.team.set_positions({name: place for name, place in usable.items() if name != self.name}, now)

    def on_robots(self, names: Sequence[str], now: float) -> None:
        """All robots that the radio reaches now."""
        came, left = self.team.set_known(names)
        if came:
            self._refresh_time = -math.inf
            self._transform_times = {n: t for n, t in self._transform_times.items() if n not in came}
        if left:
            self._dirty = True

    def on_transform(self, robot: str, transform: Optional[np.ndarray], now: float) -> None:
        """(2, 3) transform from a robot's map frame to the own one, or None while there is none."""
        if transform is not None and not is_place(*transform.ravel()):
            self._complain("transforms", f"from the frame of {robot}: check map_merger")
            transform = None
        self.foreign.set_transform(robot, transform)

    def on_frontiers(self, elements: Sequence[Element], now: float) -> None:
        for element in self._foreign_ones(elements):
            self.foreign.add(element)

    def on_visited_frontiers(self, elements: Sequence[Element], now: float) -> None:
        """Points that another robot has explored: own points there are not goals until the map had time to show it."""
        for element in self._foreign_ones(elements):
            self.foreign.remove(element.key)
            place = self.foreign.to_own_frame(element)
            if place is not None:
                self._hidden_foreign.append((place[0], place[1], now + TOLD_TIME))
        del self._hidden_foreign[:-2000]

    def on_negotiation_list(self, elements: Sequence[Element], now: float) -> None:
        """The cluster that another robot has chosen (strategies 5 and 6)."""
        chosen = self._foreign_ones(elements[:5000])
        self.on_frontiers(chosen, now)
        for robot in sorted({element.detected_by for element in chosen}):
            self.team.heard(robot)
            self.team.claim(robot, [e.key for e in chosen if e.detected_by == robot], now)

    def on_auction(self, auction: Auction, now: float) -> None:
        if auction.robot == self.name or self.team.peer(auction.robot) is None:
            return
        self.team.heard(auction.robot)
        if not auction.status:
            if self._auction is not None:
                self._auction.add(auction)
        elif auction.start:
            self._answer(auction, now)
        elif auction.finished:
            self._take_claim(auction, now)

    def on_goal_accepted(self, goal_id: int, now: float) -> None:
        self._awaited_since = now
        if self.goal is not None and self.goal.goal_id == goal_id:
            self.goal.accepted = True

    def on_goal_result(self, goal_id: int, outcome: str, text: str, now: float) -> None:
        """Outcome of a goal: `messages.REACHED`, `FAILED` or `REPLACED`. Results of former goals are ignored."""
        if self.goal is None or self.goal.goal_id != goal_id:
            return
        goal, self.goal = self.goal, None
        if self.state == State.RETURNING:
            self._home_result(outcome, now)
        elif goal.frontier is None:
            self._empty_since = None
        elif outcome == REACHED:
            self.counters.goals_reached += 1
            self._look(goal, now)
        elif outcome == FAILED:
            self._fail(goal, text, now)
        else:
            # Somebody else gave move_base a goal; let it be for a while.
            self._hold_until = now + 2.0
        self._dirty = True

    # ---- the step -------------------------------------------------------------------------------------------------

    def tick(self, now: float) -> List[Effect]:
        """What there is to do now. Cheap when nothing has changed; call it some 5 times a second and after each
        auction message."""
        if now < self._ticked - CLOCK_TOLERANCE:
            self._note(f"time went back by {self._ticked - now:.1f} s; the mission starts anew", warning=True)
            self._start_anew(now)
        self._ticked = now
        if self.started_at is None:
            self._be(State.STARTING, "waits for the start")
        elif self.map is None or self.pose is None:
            self._be(State.STARTING, "waits for " + ("the map" if self.map is None else "the robot's pose"))
        elif self.finished_at is not None:
            self._return_home(now)
        else:
            self._explore(now)
        self._periodical_log(now)
        effects, self._outbox = self._outbox, []
        return effects

    def _start_anew(self, now: float) -> None:
        """All times noted so far lie in the future. What has none stays: map, pose, home and the robots that are there.
        Numbers that they know are not given again."""
        self._drop_goal()
        started, known = self.started_at is not None, self.team.known()
        sent = {frontier.number: frontier for frontier in self.frontiers.ordered() if frontier.number in self._sent}
        self.frontiers.clear()
        self._prepare()
        self._vanished = sent
        self.on_robots(known, now)
        if self.map is not None:
            self.on_global_map(self.map, now)
        if self.pose is not None:
            self.on_pose(self.pose, now)
        if started:
            self.start(now)

    def _explore(self, now: float) -> None:
        self._perceive(now)
        self._ask_transforms(now)
        self._watch_goal(now)
        candidates = self._candidates(now)
        if self._at_end(candidates, now):
            self._finish(now)
            return
        self._close_auction_if_complete(now)
        if now >= self._hold_until:
            self._select(candidates, now)
        self._confirm_claim(now)
        self._share(now)
        if self.goal is not None:
            self._be(State.EXPLORING, f"drives to ({self.goal.pose.x:.1f}, {self.goal.pose.y:.1f})")
        elif candidates:
            self._be(State.WAITING, "frontiers are left, none is for this robot now")
        else:
            self._be(State.WAITING, "sees no frontier, waits for the map to confirm it")

    # ---- perception -----------------------------------------------------------------------------------------------

    def _perceive(self, now: float) -> None:
        assert self.map is not None and self.pose is not None
        if now - self._motion_time >= NOTHING_TIME:
            self._dirty = self._judge_looked(now) or self._dirty
        moved = math.hypot(self.pose.x - self._field_place[0], self.pose.y - self._field_place[1]) > REPLAN_DISTANCE
        due = now - self._field_time >= REPLAN_PERIOD and (moved or any(s[2] <= now for s in self._hidden_foreign))
        if not (self._map_changed or self._dirty or due):
            return
        if self._map_changed:
            self._take_map(now)
        assert self.grid is not None
        self._field = self.grid.field_from(self.pose.x, self.pose.y)
        self._views = Views(self.map, self._field, self.options.view_distance, self._views)
        self._field_place, self._field_time = (self.pose.x, self.pose.y), now
        self._map_changed = self._dirty = False
        self._assess(now)
        self.revision += 1

    def _take_map(self, now: float) -> None:
        assert self.map is not None
        robots = list(self.team.positions(now).values())
        self.grid = TravelGrid(self.map, self.options.inflation_radius, 0.6, robots)
        self._tour_grid = None
        self._other_fields = {}
        cells = frontier_cells(self.map, self.options.minimal_frontier_length)
        _, gone = self.frontiers.update(self.map, cells)
        for frontier in gone:
            if frontier.number in self._sent:
                self._vanished[frontier.number] = frontier
            self._given_up_maps.pop(frontier.number, None)
        self._judge_looked(now)
        self._revive_changed()
        self.clusters.update(self.frontiers.ordered(), self.map)
        alive = {cluster.number for cluster in self.clusters.clusters}
        self._cluster_failures = {n: c for n, c in self._cluster_failures.items() if n in alive}

    def _judge_looked(self, now: float) -> bool:
        """A frontier that is still there on a map younger than the last of several looks counts as visited; so does one
        looked at from a place where the map has stopped changing. True if there was one."""
        rests = now - self._motion_time >= NOTHING_TIME
        judged = False
        for frontier in self.frontiers.frontiers.values():
            fresh = self._map_time >= frontier.hidden_until or (rests and now >= frontier.hidden_until)
            if frontier.looks >= LOOKS and not frontier.visited and fresh:
                frontier.visited = judged = True
        return judged

    def _revive_changed(self) -> None:
        """Frontiers given up are goals again when the map around them has changed, a bounded number of times."""
        for number, (known, revivals) in list(self._given_up_maps.items()):
            frontier = self.frontiers.frontiers.get(number)
            if frontier is None:
                del self._given_up_maps[number]
            elif frontier.given_up and revivals < REVIVALS and abs(self._known_near(frontier) - known) > 20:
                frontier.given_up, frontier.failures = False, 0
                self._given_up_maps[number] = (known, revivals + 1)

    def _known_near(self, frontier: Frontier) -> int:
        """Number of known cells within a metre of a frontier."""
        assert self.map is not None
        info = self.map.info
        row, col = info.cell_of(frontier.x, frontier.y)
        reach = int(1.0 / info.resolution)
        window = self.map.cells[max(0, row - reach) : row + reach + 1, max(0, col - reach) : col + reach + 1]
        return int(np.count_nonzero(window >= 0))

    def _assess(self, now: float) -> None:
        assert self._views is not None
        self._hidden_foreign = [spot for spot in self._hidden_foreign if spot[2] > now]
        hidden = np.array([(x, y) for x, y, _ in self._hidden_foreign], dtype=float).reshape(-1, 2)
        self._view_of = {}
        goals = [f for f in self.frontiers.frontiers.values() if self._is_goal(f)]
        points = np.array([(f.x, f.y) for f in goals], dtype=float).reshape(-1, 2)
        told = {goals[index].number for index in np.flatnonzero(near_any(points, hidden, TOLD_DISTANCE))}
        self._told_explored = bool(told)
        clusters = self.clusters.clusters
        active = [[f for f in c.members if self._is_goal(f) and f.number not in told] for c in clusters]
        self._views.assess(clusters, active)
        for cluster in clusters:
            self._view_of.update(cluster.views)
        self._tour_stale = True

    def _plan_tour(self) -> None:
        """How much longer the tour through the nearest clusters gets if it starts at each of them (strategy 7)."""
        self._detours, self._tour_stale = {}, False
        stops = sorted((c for c in self.clusters.clusters if c.reachable), key=lambda c: (c.cost, c.number))
        if self.options.frontier_selection != 7 or len(stops) < 2:
            return
        if self._tour_grid is None:
            assert self.map is not None
            robots = list(self.team.positions(self._map_time).values())
            self._tour_grid = TravelGrid(
                self.map, self.options.inflation_radius, 0.6, robots, cell=TOUR_CELL, like=self.grid
            )
        near = stops[:MAXIMUM_STOPS]
        ways = ways_between(self._tour_grid, [c.viewpoint or c.centre for c in near])
        ways = np.where(np.isfinite(ways), ways, 2.0 * np.array([[c.cost for c in near]]))
        lengths = tour_lengths(np.array([c.cost for c in near]), np.minimum(ways, ways.T))
        self._detours = {c.number: float(length - lengths.min()) for c, length in zip(near, lengths)}
        for cluster in stops[MAXIMUM_STOPS:]:
            self._detours[cluster.number] = float(lengths.max() - lengths.min())

    def _is_goal(self, frontier: Frontier) -> bool:
        return not (frontier.visited or frontier.given_up)

    def _candidates(self, now: float) -> List[Cluster]:
        """Clusters with a frontier that can still be explored, now or later."""
        return [cluster for cluster in self.clusters.clusters if cluster.reachable]

    def _is_ready(self, frontier: Frontier, now: float) -> bool:
        return self._is_goal(frontier) and frontier.retry_at <= now and frontier.hidden_until <= now

    def _ready(self, clusters: Sequence[Cluster], now: float) -> List[Cluster]:
        """Those with a frontier that can be tried now."""
        members = self.frontiers.frontiers
        return [
            cluster
            for cluster in clusters
            if any(n in members and self._is_ready(members[n], now) for n in cluster.views)
        ]

    # ---- the goal on its way --------------------------------------------------------------------------------------

    def _watch_goal(self, now: float) -> None:
        goal, pose = self.goal, self.pose
        if goal is None or pose is None:
            return
        if not goal.accepted and now - goal.sent > self.options.wait_for_planner_result:
            self._send_again(goal, now)
            return
        if math.hypot(pose.x - goal.progress_place[0], pose.y - goal.progress_place[1]) > 0.3:
            goal.progress_place, goal.progress_time = (pose.x, pose.y), now
        if now - goal.progress_time > self.options.progress_timeout and goal.accepted:
            self._drop_goal()
            self._fail(goal, f"no progress for {self.options.progress_timeout:g} s", now)
            self._dirty = True
        elif goal.frontier is not None and _apart(pose, goal.pose) <= ARRIVED_DISTANCE:
            self._look(goal, now)
            self._dirty = True

    def _send_again(self, goal: Goal, now: float) -> None:
        if now - self._awaited_since <= GOAL_TRIES * self.options.wait_for_planner_result:
            self._note("move_base does not accept the goal; it is sent again", warning=True)
            self._send_goal(goal.pose, now, goal.frontier, goal.cluster)
            return
        self._drop_goal()
        self._fail(goal, f"move_base has not accepted it in {GOAL_TRIES} tries", now)
        self._dirty = True

    def _target_ready(self, goal: Goal, now: float) -> bool:
        frontier = self.frontiers.frontiers.get(goal.frontier) if goal.frontier is not None else None
        return frontier is not None and self._is_ready(frontier, now) and frontier.number in self._view_of

    def _look(self, goal: Goal, now: float) -> None:
        """The robot is where it can see the goal's frontier: what it sees now will be in the map soon."""
        for frontier in self.frontiers.frontiers.values():
            if frontier.visited or frontier.hidden_until > now:
                continue
            if frontier.number == goal.frontier or self._in_view(frontier):
                frontier.looks += 1
                frontier.hidden_until = now + LOOK_TIME

    def _in_view(self, frontier: Frontier) -> bool:
        assert self.pose is not None and self.map is not None and self.grid is not None
        pose = self.pose
        if math.hypot(frontier.x - pose.x, frontier.y - pose.y) > self.options.view_distance + 0.5:
            return False
        view = self.options.field_of_view
        return sees(self.grid.occupied, self.map, pose.x, pose.y, pose.yaw, view, frontier)

    def _fail(self, goal: Goal, text: str, now: float) -> None:
        """A goal failed. The frontier is given up in the end; another robot in the way means further tries before."""
        self.counters.goals_failed += 1
        frontier = self.frontiers.frontiers.get(goal.frontier) if goal.frontier is not None else None
        blocked = self._robot_in_the_way(goal, now)
        self._note(f"goal ({goal.pose.x:.2f}, {goal.pose.y:.2f}) failed{' behind a robot' if blocked else ''}: {text}")
        if frontier is None:
            return
        for other in self.frontiers.frontiers.values():
            if math.hypot(other.x - frontier.x, other.y - frontier.y) > 0.5:
                continue
            other.retry_at = now + (4.0 if blocked else 8.0)
            other.blocked += blocked
            if not blocked or other.blocked % BLOCKED_TRIES == 0:
                other.failures += 1
                if other.failures >= 2:
                    self._give_up(other)
        if not blocked and goal.cluster is not None:
            self._count_cluster_failure(goal.cluster)
        self._cluster = None

    def _robot_in_the_way(self, goal: Goal, now: float) -> bool:
        assert self.pose is not None
        return any(
            math.hypot(x - place.x, y - place.y) < BLOCKING_DISTANCE
            for x, y in self.team.positions(now).values()
            for place in (self.pose, goal.pose)
        )

    def _count_cluster_failure(self, number: int) -> None:
        failures = self._cluster_failures.get(number, 0) + 1
        self._cluster_failures[number] = failures
        if failures >= self.options.number_unreachable_for_cluster:
            for cluster in self.clusters.clusters:
                if cluster.number == number:
                    for member in cluster.members:
                        self._give_up(member)

    def _give_up(self, frontier: Frontier) -> None:
        if not frontier.given_up:
            frontier.given_up = True
            revivals = self._given_up_maps.get(frontier.number, (0, 0))[1]
            self._given_up_maps[frontier.number] = (self._known_near(frontier), revivals)

    def _drop_goal(self) -> None:
        if self.goal is not None:
            self._outbox.append(CancelGoal(self.goal.goal_id))
            self.goal = None

    def _send_goal(self, pose: Pose, now: float, frontier: Optional[int], cluster: Optional[int]) -> None:
        assert self.pose is not None
        if self.goal is None or self.goal.accepted:
            self._awaited_since = now
        self._goal_counter += 1
        self.counters.goals += 1
        place = (self.pose.x, self.pose.y)
        progress = now
        if self.goal is not None and frontier is not None and self.goal.frontier is not None:
            # A goal that moves on while the robot stands still must not reset the watchdog.
            place, progress = self.goal.progress_place, self.goal.progress_time
        self.goal = Goal(self._goal_counter, pose, now, frontier, cluster, progress_place=place, progress_time=progress)
        self._outbox.append(SetGoal(self._goal_counter, pose))

    # ---- selection ------------------------------------------------------------------------------------------------

    def _select(self, candidates: List[Cluster], now: float) -> None:
        ready = self._ready(candidates, now)
        strategy = self.options.frontier_selection
        if strategy == 7:
            self._select_continuous(ready, now)
        elif strategy == 1:
            self._select_auctioned(ready, now)
        elif strategy in NEGOTIATED:
            self._select_negotiated(ready, now)
        else:
            self._select_frontier(now)

    def _select_frontier(self, now: float) -> None:
        """Strategies 0, 2, 3, 4: one frontier, kept until it has vanished or was looked at."""
        assert self.pose is not None
        if self.goal is not None and self._target_ready(self.goal, now):
            return
        ready = [f for f in self.frontiers.ordered() if f.number in self._view_of and self._is_ready(f, now)]
        place = (self.pose.x, self.pose.y)
        order = choice.frontier_order(self.options.frontier_selection, self._view_of, ready, place, self._random)
        if order:
            self._drive_to(order[0], None, now)
        elif self._goal_is_over(now):
            self._drop_goal()

    def _goal_is_over(self, now: float) -> bool:
        """True if the goal's frontier is no longer one, and no answer of the map is awaited."""
        if self.goal is None or self.goal.frontier is None:
            return False
        return not any(f.hidden_until > now for f in self.frontiers.frontiers.values())

    def _drive_to(self, frontier: Frontier, cluster: Optional[int], now: float) -> None:
        x, y, _ = self._view_of[frontier.number]
        self._send_goal(Pose(x, y, math.atan2(frontier.y - y, frontier.x - x)), now, frontier.number, cluster)

    def _select_auctioned(self, ready: List[Cluster], now: float) -> None:
        """Strategy 1: stay in the cluster until it is empty or given up, then an auction; inside, the nearest."""
        if self.goal is not None and self._target_ready(self.goal, now):
            return
        current = self._current(ready)
        if current is not None:
            self._drive_in(current, now)
        elif ready:
            # When every cluster is claimed an auction leads to nothing, however often it is held.
            if self._auction is None and now - self._auction_time >= RETRY_PERIOD:
                self._need_cluster(ready, now)
        elif self._goal_is_over(now):
            self._drop_goal()

    def _select_negotiated(self, ready: List[Cluster], now: float) -> None:
        """Strategies 5 and 6: the nearest or a random cluster that nobody else has announced."""
        assert self.pose is not None
        if self.goal is not None and self._target_ready(self.goal, now):
            return
        current = self._current(ready)
        if current is None and ready:
            place = (self.pose.x, self.pose.y)
            if self.options.frontier_selection == 5:
                order = sorted(ready, key=lambda c: (choice.paper_bid(c, place), c.number))
            else:
                order = [ready[index] for index in self._random.permutation(len(ready))]
            current = next((cluster for cluster in order if not self._is_announced(cluster, now)), None)
            if current is not None:
                self._cluster = current.number
                self._announce_negotiated(current, now)
        if current is not None:
            self._drive_in(current, now)
        elif self._goal_is_over(now):
            self._drop_goal()

    def _announce_negotiated(self, cluster: Cluster, now: float) -> None:
        self._confirm_time = now
        self._outbox.append(SendFrontiers("negotiation_list", self._elements(cluster.members)))

    def _is_announced(self, cluster: Cluster, now: float) -> bool:
        """Contract 3.6: refused if 10 % of its elements are in a received list and none of it is in the own."""
        for claim in self.team.claims(now).values():
            if Listed(claim.elements, self.foreign, self.name).share_of(cluster) >= 0.1:
                return True
        return False

    def _current(self, ready: Sequence[Cluster]) -> Optional[Cluster]:
        return next((cluster for cluster in ready if cluster.number == self._cluster), None)

    def _drive_in(self, cluster: Cluster, now: float) -> None:
        """To the nearest frontier (Euclidean) of a cluster, as the paper ranks them."""
        assert self.pose is not None
        place = (self.pose.x, self.pose.y)
        members = [m for m in cluster.members if m.number in cluster.views and self._is_ready(m, now)]
        if members:
            best = min(members, key=lambda m: (choice.distance(place, (m.x, m.y)), m.number))
            self._drive_to(best, cluster.number, now)

    def _select_continuous(self, ready: List[Cluster], now: float) -> None:
        """Strategy 7: the goal follows its frontier while the map grows, and clusters are shared out anew while
        driving."""
        current = self._current(ready)
        if current is None and ready:
            if self._auction is None and now - self._auction_time >= RETRY_PERIOD:
                self._need_cluster(ready, now)
                current = self._current(ready)
            if current is None and (self._auction is not None or self.goal is None):
                # While the bids are on their way, the likely outcome is better than standing still.
                self._take(self._decide(ready, {}, now), ready, now)
                current = self._current(ready)
        elif len(ready) > 1 and self._auction is None and now - self._auction_time >= REASSIGN_PERIOD:
            self._need_cluster(ready, now)
            current = self._current(ready)
        if current is not None:
            self._follow(current, now)
        elif self._goal_is_over(now):
            self._drop_goal()

    def _follow(self, cluster: Cluster, now: float) -> None:
        """Keeps the goal at the cluster's viewpoint, without new goals for small changes."""
        if cluster.viewpoint is None or cluster.target is None:
            return
        members = self.frontiers.frontiers
        target = members.get(cluster.target)
        if target is None or not self._is_ready(target, now):
            choices = [(cluster.views[n][2], n) for n in cluster.views if self._is_ready(members[n], now)]
            if not choices:
                return
            target = members[min(choices)[1]]
        goal = self.goal
        if goal is None or goal.cluster != cluster.number or not self._still_good(goal, target, now):
            self._drive_to(target, cluster.number, now)

    def _still_good(self, goal: Goal, target: Frontier, now: float) -> bool:
        """True if the goal serves as well as the one for `target` would."""
        x, y, _ = self._view_of[target.number]
        if math.hypot(goal.pose.x - x, goal.pose.y - y) < 0.6:
            return goal.frontier == target.number or self._target_ready(goal, now)
        return self._target_ready(goal, now) and now - goal.sent < 2.0

    # ---- auctions -------------------------------------------------------------------------------------------------

    def _need_cluster(self, ready: List[Cluster], now: float) -> None:
        """Opens an auction, or decides at once where nobody would answer."""
        self._auction_time = now
        self._foreign_auctions = {r: t for r, t in self._foreign_auctions.items() if t > now}
        bidders = self.team.bidders()
        if not bidders:
            self._take(self._decide(ready, {}, now), ready, now)
            return
        if self._foreign_auctions and self.goal is not None:
            # Another auction is open: wait for its outcome before asking again.
            self._auction_time = now - REASSIGN_PERIOD + 0.5
            return
        self._share(now, force=True)
        self._auction_counter = (self._auction_counter + 1) % 2**32
        self._auction = OpenAuction(
            self._auction_counter, ready, self.name, bidders, now + self.options.auction_timeout
        )
        own = {cluster.number: self._own_bid(cluster) for cluster in ready}
        self._outbox.append(SendAuction(self._auction.start_message(own)))

    def _close_auction_if_complete(self, now: float) -> None:
        auction = self._auction
        if auction is None or not auction.complete(now):
            return
        self._auction = None
        for robot in auction.missing():
            peer = self.team.peer(robot)
            if peer is not None:
                peer.unanswered += 1
        if auction.bids:
            self.counters.auctions_completed += 1
        else:
            self.counters.auctions_uncompleted += 1
        ready = self._ready(self._candidates(now), now)
        self._take(self._decide(ready, auction.bids, now), ready, now)
        self._announce(now, auction.auction_id)

    def _take(self, cluster: Optional[Cluster], ready: Sequence[Cluster], now: float) -> None:
        """Takes the cluster that was decided on. A robot that goes empty-handed while a cluster stays unclaimed takes
        it after a while: the robot it was meant for does not know it or does not come."""
        if cluster is None and self._idle_since is not None and now - self._idle_since >= PATIENCE:
            claimed = self._claimed_clusters(ready, now)
            free = [c for c in ready if c.number not in claimed]
            cluster = min(free, key=lambda c: (self._own_bid(c), c.number)) if free else None
        if cluster is not None:
            self._cluster, self._idle_since = cluster.number, None
        else:
            self._cluster = None
            self._idle_since = now if self._idle_since is None else self._idle_since

    def _own_bid(self, cluster: Cluster) -> float:
        assert self.pose is not None
        place = (self.pose.x, self.pose.y)
        if self.options.frontier_selection != 7:
            return choice.paper_bid(cluster, place)
        x, y = cluster.viewpoint if cluster.viewpoint is not None else cluster.centre
        turn = 0.0
        if choice.distance(place, (x, y)) > 0.3:
            turn = _turn(self.pose.yaw, math.atan2(y - place[1], x - place[0]))
        if self._tour_stale:
            self._plan_tour()
        return choice.travel_bid(cluster.cost, cluster.gain, turn, self._detours.get(cluster.number, 0.0))

    def _decide(
        self, ready: Sequence[Cluster], bids: Mapping[str, Mapping[int, float]], now: float
    ) -> Optional[Cluster]:
        """The cluster for this robot by the Hungarian assignment over the bids, given or interpolated."""
        claimed_by = self._claimed_clusters(ready, now)
        robots = [r for r in self.team.competitors(now) if r not in bids or bids[r]]
        costs = cost_matrix(
            len(ready), robots, choice.bids_by_row(ready, bids), self.team.positions(now), self._interpolation(ready)
        )
        if self.options.frontier_selection == 7:
            self._leave_out_unknown(costs, ready, robots, bids)
        keep = [column for column in range(len(robots)) if np.isfinite(costs[:, column]).any()]
        robots, costs = [robots[column] for column in keep], costs[:, keep]
        own = np.array([self._own_bid(cluster) for cluster in ready], dtype=float)
        if self.options.frontier_selection != 7:
            return self._decide_as_paper(ready, own, robots, costs, claimed_by)
        own = own + self._crowding(ready, now)
        for row, cluster in enumerate(ready):
            holder = claimed_by.get(cluster.number)
            if holder in robots:
                costs[row, robots.index(holder)] -= 2 * choice.LOYALTY
            elif holder is not None:
                own[row] = math.inf
            if cluster.number == self._cluster:
                own[row] -= choice.LOYALTY
        return choice.assigned_cluster(ready, own, robots, costs)

    @staticmethod
    def _leave_out_unknown(
        costs: np.ndarray,
        ready: Sequence[Cluster],
        robots: Sequence[str],
        bids: Mapping[str, Mapping[int, float]],
    ) -> None:
        """A robot that has answered without a bid for a cluster does not know it and will not go there, however near it
        is: nobody may be left empty-handed for its sake."""
        for column, robot in enumerate(robots):
            if robot in bids:
                unknown = [row for row, cluster in enumerate(ready) if cluster.number not in bids[robot]]
                costs[unknown, column] = math.inf

    def _decide_as_paper(
        self,
        ready: Sequence[Cluster],
        own: np.ndarray,
        robots: Sequence[str],
        costs: np.ndarray,
        claimed_by: Mapping[int, str],
    ) -> Optional[Cluster]:
        """Contract 3.7: used clusters cost too much in every row; with fewer clusters than robots the nearest."""
        free = [row for row, cluster in enumerate(ready) if cluster.number not in claimed_by]
        clusters = [ready[row] for row in free]
        if not clusters:
            return None
        if len(ready) < len(robots) + 1:
            return clusters[int(np.argmin(own[free]))]
        return choice.assigned_cluster(clusters, own[free], robots, costs[free])

    def _claimed_clusters(self, clusters: Sequence[Cluster], now: float) -> Dict[int, str]:
        """{cluster number: robot} of the clusters that other robots have claimed."""
        result: Dict[int, str] = {}
        for robot, claim in self.team.claims(now).items():
            cluster = match(clusters, claim.elements, self.foreign, self.name)
            if cluster is not None:
                result.setdefault(cluster.number, robot)
        return result

    def _crowding(self, clusters: Sequence[Cluster], now: float) -> np.ndarray:
        claims = self.team.claims(now).values()
        places = [places_of(claim.elements, self.foreign, self.name) for claim in claims]
        return np.array([choice.crowd_penalty(cluster, places) for cluster in clusters])

    def _interpolation(self, clusters: Sequence[Cluster]):  # type: ignore[no-untyped-def]
        """The cost of a cluster (by row) for a robot at a position that gave no bid, in the unit of the strategy."""

        def cost(position: Tuple[float, float], row: int) -> float:
            cluster = clusters[row]
            if self.options.frontier_selection != 7:
                return squared_euclidean(position, choice.nearest_member(cluster, position))
            place = cluster.viewpoint if cluster.viewpoint is not None else cluster.centre
            length = self._field_of_other(position).at(*place)
            if not math.isfinite(length):
                length = 2.0 * choice.distance(position, place)
            return choice.travel_bid(length, cluster.gain)

        return cost

    def _field_of_other(self, position: Tuple[float, float]) -> CostField:
        """Costs from another robot's place, kept until the map changes or the robot has moved on."""
        assert self.grid is not None
        place = (round(2 * position[0]) / 2, round(2 * position[1]) / 2)
        field = self._other_fields.pop(place, None)
        if field is None:
            field = self.grid.field_from(*place)
            while len(self._other_fields) >= max(FEWEST_FIELDS, len(self.team.known())):
                del self._other_fields[next(iter(self._other_fields))]
        self._other_fields[place] = field  # the last one used comes last
        return field

    def _answer(self, auction: Auction, now: float) -> None:
        """Bids for each cluster on offer that is one of the own ones (40 % rule); no list at all if this robot has
        finished or cannot place the other's frontiers, so that it is not waited for nor counted."""
        self._foreign_auctions[auction.robot] = now + self.options.auction_timeout
        peer = self.team.peer(auction.robot)
        available = []
        if peer is not None:
            peer.bids = {frozenset(bid.elements): bid.bid for bid in auction.requested[:500]}
        if self.finished_at is None and self.pose is not None and self._may_compare(auction.requested):
            candidates = self._candidates(now)
            for bid in auction.requested[:500]:
                cluster = match(candidates, bid.elements, self.foreign, self.name)
                offered = -1.0 if cluster is None else self._own_bid(cluster)
                available.append(Bid(bid.elements, offered))
        self._outbox.append(SendAuction(reply_message(self.name, auction.auction_id, available)))

    def _may_compare(self, requested: Sequence[Bid]) -> bool:
        robots = {key[0] for bid in requested for key in bid.elements}
        return any(robot == self.name or self.foreign.has_transform(robot) for robot in robots)

    def _take_claim(self, auction: Auction, now: float) -> None:
        self._foreign_auctions.pop(auction.robot, None)
        peer = self.team.peer(auction.robot)
        bid = None
        if peer is not None:
            occupied = set(auction.occupied)
            for elements, value in peer.bids.items():
                if len(occupied & elements) * 2 > len(occupied):
                    bid = value
        self.team.claim(auction.robot, auction.occupied[:5000], now, bid)
        self._settle_conflict(auction.robot, now)

    def _settle_conflict(self, robot: str, now: float) -> None:
        """Two robots chose the same cluster at once: the lower bid keeps it, on equal bids the lesser name."""
        claim = self.team.claims(now).get(robot)
        own = next((c for c in self.clusters.clusters if c.number == self._cluster), None)
        if claim is None or own is None or self.options.frontier_selection not in COORDINATED:
            return
        meant = match(self.clusters.clusters, claim.elements, self.foreign, self.name)
        if meant is None or meant.number != own.number:
            return
        theirs = claim.bid
        if theirs is None or theirs < 0:
            position = self.team.positions(now).get(robot)
            theirs = self._interpolation([own])(position, 0) if position is not None else math.inf
        mine = self._own_bid(own) if own.reachable else math.inf
        if (mine, self.name) <= (theirs, robot):
            self._confirm_time = min(self._confirm_time, now - CONFIRM_PERIOD + 1.0)
        else:
            self._cluster = None
            self._claimed = ()
            self._auction_time = -math.inf

    def _announce(self, now: float, auction_id: int) -> None:
        own = next((c for c in self.clusters.clusters if c.number == self._cluster), None)
        self._claimed = elements_of(own, self.name) if own is not None else ()
        self._confirm_time = now
        self._share(now, force=True)
        self._outbox.append(SendAuction(closing_message(self.name, auction_id, self._claimed)))

    def _confirm_claim(self, now: float) -> None:
        """Tells the others when the own cluster is another one than they know, and now and then that it still is."""
        if not self.team.known() or self._auction is not None:
            return
        own = next((c for c in self.clusters.clusters if c.number == self._cluster), None)
        if self.options.frontier_selection in COORDINATED:
            self._confirm_auctioned(own, now)
        elif own is not None and own.reachable and now - self._confirm_time >= CONFIRM_PERIOD:
            self._announce_negotiated(own, now)

    def _confirm_auctioned(self, own: Optional[Cluster], now: float) -> None:
        age = now - self._confirm_time
        if age < SHARE_PERIOD:
            return
        elements = set(elements_of(own, self.name)) if own is not None else set()
        kept = len(elements & set(self._claimed))
        changed = (kept * 2 < len(elements)) or (not elements and bool(self._claimed))
        if changed or (elements and age >= CONFIRM_PERIOD):
            self._announce(now, self._auction_counter)

    # ---- frontiers on the air -------------------------------------------------------------------------------------

    def _share(self, now: float, force: bool = False) -> None:
        """Sends what the others do not have yet: new points, and points that are explored."""
        if not self.team.known() or (now - self._share_time < SHARE_PERIOD and not force):
            return
        if now - self._refresh_time >= REFRESH_PERIOD:
            self._sent = set()
            self._refresh_time = now
        new = [f for f in self.frontiers.ordered() if f.number not in self._sent and not f.visited]
        if new:
            self._outbox.append(SendFrontiers("frontiers", self._elements(new)))
            self._sent.update(f.number for f in new)
        if self._vanished:
            gone = [self._vanished[number] for number in sorted(self._vanished)]
            self._outbox.append(SendFrontiers("visited_frontiers", self._elements(gone)))
            self._sent.difference_update(self._vanished)
            self._vanished = {}
        if new or force:
            self._share_time = now

    def _elements(self, frontiers: Sequence[Frontier]) -> Tuple[Element, ...]:
        return tuple(Element(self.name, f.number, f.x, f.y) for f in frontiers)

    def _foreign_ones(self, elements: Sequence[Element]) -> List[Element]:
        """Those of robots that are known, at places that can be."""
        usable = []
        for element in elements:
            if not is_place(element.x, element.y):
                self._complain("frontiers", f"of {element.detected_by}: check its explorer")
            elif element.detected_by != self.name and self.team.peer(element.detected_by) is not None:
                usable.append(element)
        return usable

    def _ask_transforms(self, now: float) -> None:
        for robot in self.foreign.robots():
            if now - self._transform_times.get(robot, -math.inf) >= TRANSFORM_PERIOD:
                self._transform_times[robot] = now
                self._outbox.append(AskTransform(robot))

    # ---- the end --------------------------------------------------------------------------------------------------

    def _at_end(self, candidates: Sequence[Cluster], now: float) -> bool:
        """True when no reachable frontier has been left for `finish_delay`, on maps younger than the last motion."""
        assert self._field is not None
        if candidates or self._told_explored or not self._field.reachable.any():
            self._empty_since = None
            return False
        if self.goal is not None and self.goal.frontier is None:
            # On the way to a closer look.
            return False
        if self._empty_since is None:
            self._empty_since = now
            self._drop_goal()
            self._cluster = None
        rest = now - self._motion_time
        fresh = min(self._map_time, self._own_map_time) > self._motion_time or rest >= NOTHING_TIME
        if now - self._empty_since < self.options.finish_delay or not fresh:
            return False
        return not (self._try_given_up_again() or self._look_closer(now))

    def _try_given_up_again(self) -> bool:
        """Before the end every frontier that was given up gets one more try; True if there was one."""
        again = False
        for number, (known, revivals) in list(self._given_up_maps.items()):
            frontier = self.frontiers.frontiers.get(number)
            if frontier is not None and frontier.given_up and revivals < 1:
                frontier.given_up, frontier.failures = False, 1
                self._given_up_maps[number] = (known, revivals + 1)
                again = True
        self._dirty = self._dirty or again
        return again

    def _look_closer(self, now: float) -> bool:
        """Before the end the robot goes as near as it can to frontiers that no reachable place sees, and faces them:
        what blocks the way may be the trace of a robot that has left. True if it is on its way."""
        assert self._field is not None and self.pose is not None
        place = (self.pose.x, self.pose.y)
        hopeless = [
            cluster
            for cluster in self.clusters.clusters
            if not cluster.reachable and sum(self._is_goal(member) for member in cluster.members) >= WORTH_A_LOOK
        ]
        for cluster in sorted(hopeless, key=lambda c: (choice.distance(place, c.centre), c.number)):
            spot = (round(cluster.centre[0]), round(cluster.centre[1]))
            tries = self._closer_looks.get(spot, 0)
            if tries >= 2 or sum(self._closer_looks.values()) >= CLOSER_LOOKS:
                continue
            self._closer_looks[spot] = tries + 1
            x, y = self._field.nearest_place(*cluster.centre)
            # A turn shows the laser, and with it the map, what is there now; the second look turns further.
            yaw = math.atan2(cluster.centre[1] - y, cluster.centre[0] - x) + (1.0 if tries else 0.0)
            self._note(f"takes a closer look at unreachable frontiers near ({spot[0]}, {spot[1]})")
            self._send_goal(Pose(x, y, yaw), now, None, None)
            return True
        return False

    def _finish(self, now: float) -> None:
        assert self.started_at is not None
        self.finished_at = now
        self._drop_goal()
        self._cluster, self._auction = None, None
        if self.team.known() and self.options.frontier_selection in COORDINATED:
            self._announce(now, self._auction_counter)
        self._note(f"exploration finished after {now - self.started_at:.1f} s")
        self._write_exploration_log(now, complete=True)
        self._log_maps(LOG_MAPS_AT_END)
        self._return_home(now)

    def _return_home(self, now: float) -> None:
        assert self.pose is not None and self.home is not None
        if self.state == State.FINISHED:
            return
        at_home = _apart(self.pose, self.home) <= HOME_DISTANCE
        if not self.options.return_home or at_home or self._home_attempts >= HOME_ATTEMPTS:
            self._drop_goal()
            place = "at home" if at_home else "away from home"
            self._be(State.FINISHED, f"finished, {place}")
            return
        if self.state != State.RETURNING:
            self._be(State.RETURNING, "finished, drives home")
        self._watch_home(now)
        if self.goal is None and now >= self._hold_until:
            self._send_goal(self.home, now, None, None)

    def _watch_home(self, now: float) -> None:
        goal = self.goal
        if goal is None:
            return
        self._watch_goal(now)
        if self.goal is None:
            self._home_attempts += 1
            self._hold_until = now + 3.0

    def _home_result(self, outcome: str, now: float) -> None:
        if outcome != REACHED:
            self._home_attempts += 1
            self._hold_until = now + 3.0
        else:
            # As near as move_base gets.
            self._home_attempts = HOME_ATTEMPTS

    # ---- logs and state -------------------------------------------------------------------------------------------

    def _be(self, state: State, text: str) -> None:
        self.state, self.text = state, text

    def _note(self, text: str, warning: bool = False) -> None:
        self._outbox.append(Note(text, warning))

    def _complain(self, what: str, text: str) -> None:
        """One line for each kind of input with coordinates that cannot be, however often it comes."""
        if what not in self._complaints:
            self._complaints.add(what)
            self._note(f"{what} that are no numbers or farther than {FARTHEST:g} m are ignored, {text}", warning=True)

    def exploration_time(self, now: float) -> float:
        """Seconds from the start of the mission, fixed once finished (T_r)."""
        if self.started_at is None:
            return 0.0
        return (self.finished_at if self.finished_at is not None else now) - self.started_at

    def unreachable_count(self) -> int:
        """Frontiers that are given up, or that no reachable place sees."""
        return sum(
            1
            for f in self.frontiers.frontiers.values()
            if f.given_up or (not f.visited and f.number not in self._view_of)
        )

    def _periodical_log(self, now: float) -> None:
        if self.started_at is None or self.finished_at is not None or now - self._log_time < LOG_PERIOD:
            return
        self._log_time = now
        elapsed = now - self.started_at
        free = int(np.count_nonzero(self.map.cells == 0)) if self.map is not None else 0
        values = {
            "time": elapsed,
            "travel_path_overall": self.counters.distance,
            "average_path": self.counters.distance / max(1, self.counters.goals),
            "global_costmap_explored_cells": free,
            "local_costmap_explored_cells": -1,
            "fallback_iterations": 0,
            "completed_auctions": self.counters.auctions_completed,
            "uncompleted_auctions": self.counters.auctions_uncompleted,
            "frontier_selection_strategy": self.options.frontier_selection,
            "local_costmap_width": self.options.local_costmap_width,
            "unreachable_frontiers": self.unreachable_count(),
        }
        self._outbox.append(WriteLog("periodical.log", logs.periodical_line(values), append=True))
        self._write_exploration_log(now, complete=False)
        self._log_maps(LOG_MAPS)

    def _log_maps(self, mask: int) -> None:
        """Without log files here there are none of map_merger either: it refuses the call, which is no failure."""
        if self.options.log_path:
            self._outbox.append(LogOutput(mask))

    def _write_exploration_log(self, now: float, complete: bool) -> None:
        assert self.started_at is not None
        values = {
            "time_file_written": f"{now:.3f}",
            "start_time": f"{self.started_at:.3f}",
            "end_time": f"{now:.3f}",
            "exploration_time": f"{self.exploration_time(now):.3f}",
            "required_goals": self.counters.goals,
            "unreachable_goals": self.counters.goals_failed,
            "travel_path_overall": f"{self.counters.distance:.3f}",
            "number_of_completed_auctions": self.counters.auctions_completed,
            "number_of_uncompleted_auctions": self.counters.auctions_uncompleted,
            "frontier_selection_strategy": self.options.frontier_selection,
            "costmap_size": self.map.cells.size if self.map is not None else 0,
            "global costmap iterations": self.counters.maps,
            "explorer_local_costmap_height": self.options.local_costmap_height,
            "explorer_local_costmap_width": self.options.local_costmap_width,
            "complete": int(complete),
        }
        name = "exploration.log" if complete else "exploration.log.tmp"
        self._outbox.append(WriteLog(name, logs.exploration_log(values)))


def _apart(a: Pose, b: Pose) -> float:
    return math.hypot(a.x - b.x, a.y - b.y)


def _turn(before: float, after: float) -> float:
    """Smallest turn from one heading to another, rad."""
    return math.atan2(math.sin(after - before), math.cos(after - before))
