"""The robots of a team, the transforms that anybody has found between them, and where that places each robot."""

import math
from functools import lru_cache
from typing import Dict, Iterable, List, NamedTuple, Optional, Set, Tuple

import numpy as np

from mr_grid import Pose, normalized

from ..covariance import Covariance, as_covariance
from ..messages import NO_BOOT, Boot
from .change import Change, differ
from .consistency import Choice, largest_consistent
from .edges import MOST_EDGES, MOST_ROBOTS, Edge, EdgeError, EdgeReport, arm_to_walls, check
from .links import links_of
from .pose_graph import Poses, relative, relative_covariance
from .words import contradiction

_KEPT_RUNS = 2
"""Of a reporter: a late report of its former run must not push out that of the present one."""
_KEPT_CHOICES = 16
"""Where a whole team runs in one process its robots mostly know the same edges, so one of them chooses for all."""
_CHANGE = Change(distance_m=0.01, rotation_rad=math.radians(0.05), weight=0.1, covariance=1.5)
"""What changes by less, a fifth of what every edge is uncertain by, leaves the poses where they are."""


class Placement(NamedTuple):
    """Where a robot's frame lies in the own one: transform and covariance. via: the robots in between, nearest to the
    own one first; empty if an edge joins both."""

    transform: Pose
    covariance: Covariance
    via: Tuple[str, ...]


class Dropped(NamedTuple):
    """An edge that the others contradict, and how. via: the robots along which they do."""

    edge: Edge
    words: str
    via: Tuple[str, ...]

    @property
    def cycle(self) -> Tuple[str, ...]:
        """The robots around the contradiction."""
        return (self.edge.reporter, *self.via, self.edge.target)


class _Solution(NamedTuple):
    placed: Dict[str, Placement]
    kept: Tuple[Edge, ...]
    dropped: Tuple[Dropped, ...]


class TeamGraph:
    """Own edges and those that others tell. The same edges give every robot the same graph; each sees it from its own
    frame.

    Robots are told apart by name and run: an edge to or from another run than the present one of a robot is left out.
    """

    def __init__(self, own: str, run: Boot) -> None:
        """own: name of the robot whose frame is the own one. run: names the run of that frame."""
        self._own = own
        self._runs: Dict[str, Boot] = {own: run}
        self._own_edges: Tuple[Edge, ...] = ()
        self._reports: Dict[str, Dict[Boot, EdgeReport]] = {}
        self._forgotten: List[str] = []
        self._solution: Optional[_Solution] = None

    def begin_run(self, run: Boot) -> None:
        """The own frame is a new one: no own edge holds any more."""
        self._runs[self._own], self._own_edges, self._solution = run, (), None

    def set_own(self, edges: Iterable[Edge]) -> Tuple[str, ...]:
        """All edges that this robot has found itself. Returns why some are refused, as `heard` does for others."""
        edges = tuple(edges)
        if not differ(self._own_edges, edges, _CHANGE):
            return ()
        usable, refused = _usable(edges, self._own_edges)
        if usable != self._own_edges:
            self._own_edges, self._solution = usable, None
        return refused

    def own(self) -> Tuple[Edge, ...]:
        """The own edges by which robots are placed: those set last, or former ones that hardly differ."""
        return self._own_edges

    def set_run(self, robot: str, run: Boot) -> None:
        """The present run of a robot; edges of its former ones vanish."""
        self._remember(robot)
        known = robot in self._runs or len(self._runs) < MOST_ROBOTS
        if robot != self._own and known and self._runs.get(robot) != run:
            self._runs[robot], self._solution = run, None

    def heard(self, report: EdgeReport) -> Tuple[str, ...]:
        """A robot told its edges, in place of those it told before in that run. Returns why some of it, or all, is
        refused."""
        if report.robot == self._own or not report.robot:
            return (f"transforms told in the name of {report.robot!r} ignored",)
        if report.robot not in self._reports and len(self._reports) >= MOST_ROBOTS - 1:
            return (f"transforms of {report.robot} ignored: {MOST_ROBOTS} robots tell theirs already",)
        self._remember(report.robot)
        runs = self._reports.setdefault(report.robot, {})
        before = runs.pop(report.boot, None)
        known = () if before is None else before.edges
        edges, refused = _usable(report.edges, known, (report.robot, report.boot))
        changed = before is None or differ(before.edges, edges, _CHANGE)
        runs[report.boot] = EdgeReport(report.robot, report.boot, edges) if before is None or changed else before
        self._bound_runs(report.robot)
        if report.robot not in self._runs:
            self.set_run(report.robot, report.boot)
        if changed:
            self._solution = None
        return refused

    def forget(self, robot: str) -> None:
        """Nothing that the robot told, and no run of it, is known any more; what others tell of it counts again when
        it is heard, or when MOST_ROBOTS others have been forgotten."""
        if robot != self._own:
            self._reports.pop(robot, None)
            self._runs.pop(robot, None)
            self._remember(robot)
            self._forgotten = [*self._forgotten, robot][-MOST_ROBOTS:]
            self._solution = None

    def placed(self) -> Dict[str, Placement]:
        """Every other robot that consistent edges join to the own one, by name."""
        return self._solved().placed

    def kept(self) -> Tuple[Edge, ...]:
        """The edges that agree, in the order of their names."""
        return self._solved().kept

    def dropped(self) -> Tuple[Dropped, ...]:
        """The edges that contradict those."""
        return self._solved().dropped

    def refuted(self) -> Dict[str, str]:
        """Own edges among the dropped: the other robot's name, and how they are contradicted."""
        return {each.edge.target: each.words for each in self.dropped() if each.edge.reporter == self._own}

    def disputed(self) -> Set[str]:
        """The robots whose own edge is part of a contradiction, dropped or not: one of those around it is wrong."""
        robots: Set[str] = set()
        for cycle in (each.cycle for each in self.dropped()):
            for first, second in zip(cycle, (*cycle[1:], cycle[0])):
                robots.update({first, second} if self._own in (first, second) else ())
        return robots - {self._own}

    def _remember(self, robot: str) -> None:
        if robot in self._forgotten:
            self._forgotten.remove(robot)
            self._solution = None

    def _bound_runs(self, robot: str) -> None:
        runs = self._reports[robot]
        while len(runs) > _KEPT_RUNS:
            del runs[next(run for run in runs if run != self._runs.get(robot))]

    def _solved(self) -> _Solution:
        if self._solution is None:
            self._solution = _best_solution(self._own, self._present())
        return self._solution

    def _present(self) -> List[Edge]:
        """All edges between present runs, ordered by reporter and target, one each."""
        told = [edge for runs in self._reports.values() for report in runs.values() for edge in report.edges]
        edges = sorted([*self._own_edges, *told], key=lambda edge: (edge.reporter, edge.target))
        edges = [edge for edge in edges if not set(edge.pair) & set(self._forgotten)]
        strangers = [edge for edge in edges if edge.reporter not in self._runs or edge.target not in self._runs]
        runs = {**_likely_runs(strangers), **self._runs}
        present = {
            (edge.reporter, edge.target): edge
            for edge in edges
            if _same_run(edge.reporter_run, runs[edge.reporter]) and _same_run(edge.target_run, runs[edge.target])
        }
        return list(present.values())


def _usable(
    told: Tuple[Edge, ...], known: Tuple[Edge, ...], teller: Optional[Tuple[str, Boot]] = None
) -> Tuple[Tuple[Edge, ...], Tuple[str, ...]]:
    """What may be used of what was told, one edge to each robot, and why the rest may not. `known`: what was found
    usable before; most of it is told again."""
    edges: Dict[str, Edge] = {}
    before = {edge.target: edge for edge in known}
    refused = []
    for edge in told[:MOST_EDGES]:
        try:
            if edge != before.get(edge.target) or not 0.0 <= edge.age < math.inf:
                check(edge)
            if teller is not None and (edge.reporter, edge.reporter_run) != teller:
                raise EdgeError(f"transform {edge.reporter} - {edge.target}: told by {teller[0]}")
            if edge.target in edges:
                raise EdgeError(f"transform {edge.reporter} - {edge.target}: told twice")
            edges[edge.target] = edge
        except EdgeError as error:
            refused.append(f"{error}; refused")
    if len(told) > MOST_EDGES:
        refused.append(f"{told[0].reporter} tells {len(told)} transforms; those beyond {MOST_EDGES} are refused")
    return tuple(edges[target] for target in sorted(edges)), tuple(refused)


def _same_run(told: Boot, present: Boot) -> bool:
    return told == present or NO_BOOT in (told, present)


def _likely_runs(edges: Iterable[Edge]) -> Dict[str, Boot]:
    """For each robot the run that most of the evidence names."""
    weights: Dict[str, Dict[Boot, float]] = {}
    for edge in edges:
        for robot, run in ((edge.reporter, edge.reporter_run), (edge.target, edge.target_run)):
            runs = weights.setdefault(robot, {})
            runs[run] = runs.get(run, 0.0) + edge.weight
    return {robot: max(runs, key=lambda run: (runs[run], run)) for robot, runs in weights.items()}


def _best_solution(own: str, edges: List[Edge]) -> _Solution:
    """Without the edges from the farthest walls, as many as rounding makes unsolvable."""
    while True:
        try:
            return _solution_of(own, edges)
        except ValueError:
            if not edges:
                raise
            arms = arm_to_walls(np.array([edge.covariance for edge in edges]))[:, :2, 2]
            del edges[int(np.argmax(np.hypot(*arms.T)))]


@lru_cache(maxsize=_KEPT_CHOICES)
def _choice(edges: Tuple[Edge, ...], nodes: Tuple[str, ...]) -> Choice:
    return largest_consistent(links_of(edges, nodes), len(nodes))


def _solution_of(own: str, edges: List[Edge]) -> _Solution:
    nodes = sorted({own, *(robot for edge in edges for robot in edge.pair)})
    choice = _choice(tuple(edges), tuple(nodes))
    kept = tuple(edge for edge, chosen in zip(edges, choice.chosen) if chosen)
    left_out = [edge for edge, chosen in zip(edges, choice.chosen) if not chosen]
    neighbours = _neighbours(kept)
    routes = {robot: _routes(robot, neighbours) for robot in {edge.reporter for edge in left_out}}
    dropped = []
    for edge in left_out:
        via = routes[edge.reporter].get(edge.target, ())
        dropped.append(Dropped(edge, contradiction(edge, choice.poses, nodes, via), via))
    return _Solution(_placements(choice.poses, nodes, own, _routes(own, neighbours)), kept, tuple(dropped))


def _placements(poses: Poses, nodes: List[str], own: str, routes: Dict[str, Tuple[str, ...]]) -> Dict[str, Placement]:
    robots = sorted(routes)
    there = np.array([nodes.index(robot) for robot in robots], int)
    here = np.full(len(there), nodes.index(own))
    return {
        robot: Placement(Pose(x, y, normalized(yaw)), as_covariance(covariance), routes[robot])
        for robot, (x, y, yaw), covariance in zip(
            robots, relative(poses.mean, here, there).tolist(), relative_covariance(poses, here, there)
        )
    }


def _neighbours(edges: Iterable[Edge]) -> Dict[str, List[str]]:
    pairs = sorted({edge.pair for edge in edges})
    neighbours: Dict[str, List[str]] = {}
    for first, second in pairs:
        neighbours.setdefault(first, []).append(second)
        neighbours.setdefault(second, []).append(first)
    return neighbours


def _routes(start: str, neighbours: Dict[str, List[str]]) -> Dict[str, Tuple[str, ...]]:
    """The robots between the start and every robot that edges join to it, along the fewest edges."""
    routes: Dict[str, Tuple[str, ...]] = {}
    waiting: List[Tuple[str, Tuple[str, ...]]] = [(start, ())]
    for robot, via in waiting:
        for neighbour in sorted(neighbours.get(robot, ())):
            if neighbour != start and neighbour not in routes:
                routes[neighbour] = via
                waiting.append((neighbour, (*via, neighbour)))
    return routes
