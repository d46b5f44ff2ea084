"""Wrong transforms that a robot of a team believes strongly: how soon the team is rid of them.

Teams of four explore an office from one place and go on while it happens, so maps grow. Own transforms between some
pairs are given as if those robots had met, so that each team is connected; the rest is up to the agents. Then one
pair's transform goes wrong, on one of the two robots or on both, with more evidence than a right one has.
"""

import math
from dataclasses import dataclass, field
from typing import Dict, FrozenSet, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from mr_grid import Pose

from ..agent import Agent
from ..evidence import Evidence, compare
from ..graph.edges import Edge
from ..job import Job
from ..options import options_of
from ..registration import Registration, Verdict
from ..surface import landmarks_of
from ..synthetic import RobotMap, Survey, Surveyor, office_plan, pair_of
from ..transform import rotation_between
from .figures import Row, row
from .virtual_team import VirtualTeam

ROBOTS = 4
BAR_S = 30.0
"""Within so many s it must be gone on every robot."""
SETTLING_S = 15.0
WATCHED_S = 60.0
GROWTH_PERIOD_S = 5.0
"""A robot has a new map this often."""
STAGES = tuple(np.linspace(0.4, 1.0, 16).tolist())
"""Shares of the way explored: the first before anything goes wrong."""
PATH_M = 40.0
WRONG_M, WRONG_RAD = 0.5, math.radians(5.0)
_STRONG = Evidence(60.0, 20.0, 0.0, 0.9, 0.02)
_COVARIANCE = ((0.003, 0.0, 0.0), (0.0, 0.003, 0.0), (0.0, 0.0, 0.0001))

Pair = Tuple[str, str]


class Injection(NamedTuple):
    """robots: who is misled, about whom; `both`: each about the other. cycle: the wrong transform lies in a cycle of
    own ones. gone: s until no robot told it or placed anybody wrongly; None if that took longer than the team was
    watched. placed: how many robots were placed right at the end, on all robots together."""

    seed: int
    robots: Pair
    both: bool
    cycle: bool
    gone: Optional[float]
    placed: int


@dataclass
class MetTeam(VirtualTeam):
    """Given pairs have met: their first registrations give the truth. truth: of the second's frame to the first's."""

    truth: Dict[Pair, Pose] = field(default_factory=dict)
    met: FrozenSet[Pair] = frozenset()
    meeting: bool = True
    """Only at the start."""

    def outcome(self, name: str, job: Job) -> Registration:
        pair = min(name, job.robot), max(name, job.robot)
        if job.current is not None or pair not in self.met or not self.meeting:
            return super().outcome(name, job)
        truth = self.truth[name, job.robot]
        evidence = compare(landmarks_of(job.target.grid), landmarks_of(job.source.grid), truth)
        return Registration(Verdict.ACCEPTED, truth, evidence, met=True, covariance=_COVARIANCE)


def inject(seed: int, watched: float = WATCHED_S, robots: int = ROBOTS) -> Injection:
    """One team of so many robots and one wrong transform, watched for so many s."""
    random = np.random.default_rng(seed)
    maps = explored(random, robots)
    team = team_of(maps, _connected(random, sorted(maps)))
    grow(team, maps, 0)
    team.run(SETTLING_S)
    team.meeting = False
    first, second = random.choice(sorted(maps), 2, replace=False).tolist()
    both = bool(random.random() < 0.5)
    cycle = _in_cycle(told(team), (first, second), both)
    x, y = (random.uniform(3.0, 9.0, 2) * random.choice([-1.0, 1.0], 2)).tolist()
    shift = Pose(float(x), float(y), random.uniform(-3.0, 3.0))
    wrong = team.truth[first, second].compose(shift)
    mislead(team, first, second, wrong)
    if both:
        mislead(team, second, first, wrong.inverse())
    gone = None
    for number in range(1, round(watched / 0.5) + 1):
        if number % round(2.0 * GROWTH_PERIOD_S) == 0:
            grow(team, maps, round(0.5 * number / GROWTH_PERIOD_S))
        team.run(0.5)
        clean = not _believed(team, (first, second), wrong) and all(_placements(team))
        gone = (0.5 * number if gone is None else gone) if clean else None
    return Injection(seed, (first, second), both, cycle, gone, sum(_placements(team)))


def mislead(team: VirtualTeam, name: str, robot: str, wrong: Pose) -> None:
    """Robot `name` believes from now on that this transform lays the frame of `robot` in its own."""
    outcome = Registration(Verdict.ACCEPTED, wrong, _STRONG, prior=True, met=True, covariance=_COVARIANCE)
    team.mislead(name, robot, outcome)


def explored(random: np.random.Generator, robots: int = ROBOTS) -> Dict[str, RobotMap]:
    """Maps of robots that set off from one place in an office, by name, in STAGES."""
    surveyor = Surveyor(office_plan(random))
    survey = Survey(path_length=PATH_M, stages=STAGES)
    first = surveyor.explore(random, survey)
    start = (float(first.path[0, 0]), float(first.path[0, 1]))
    rest = [surveyor.explore(random, survey, start=start, yaw=2.0 * number + 0.4) for number in range(robots - 1)]
    return {f"robot_{number}": each for number, each in enumerate([first, *rest])}


def _connected(random: np.random.Generator, names: Sequence[str]) -> FrozenSet[Pair]:
    """Pairs that join all: a random tree and some more."""
    order = random.permutation(names).tolist()
    pairs = {(order[number], order[int(random.integers(number))]) for number in range(1, len(order))}
    pairs |= {(one, other) for one in names for other in names if one < other and random.random() < 0.25}
    return frozenset((min(pair), max(pair)) for pair in pairs)


def team_of(maps: Dict[str, RobotMap], met: FrozenSet[Pair]) -> MetTeam:
    """Agents that know nothing yet, of whom these pairs meet."""
    agents = {name: Agent(options_of({"debug": False}, name), (1, number)) for number, name in enumerate(sorted(maps))}
    truth = {(one, other): pair_of(maps[one], maps[other]).truth for one in maps for other in maps if one != other}
    return MetTeam(agents, truth=truth, met=met)


def grow(team: MetTeam, maps: Dict[str, RobotMap], stage: int) -> None:
    """Every robot has explored as far as this stage."""
    for name, each in maps.items():
        team.agents[name].on_local_map(each.stages[min(stage, len(each.stages) - 1)], team.now)


def told(team: VirtualTeam) -> List[Edge]:
    """What the robots told last of their own transforms."""
    return [edge for report in team.edges.values() for edge in report.edges]


def _in_cycle(edges: Sequence[Edge], pair: Pair, both: bool) -> bool:
    """True if own transforms join the pair though this one of them (or both of the pair) is left out."""
    first, second = pair
    reached = {first}
    left = [edge for edge in edges if (edge.reporter, edge.target) != pair]
    left = [edge for edge in left if not (both and {edge.reporter, edge.target} == set(pair))]
    for _ in edges:
        reached |= {robot for edge in left for robot in edge.pair if reached & set(edge.pair)}
    return second in reached


def _believed(team: VirtualTeam, pair: Pair, wrong: Pose) -> bool:
    """True while one of the pair tells the wrong transform."""
    own = {(edge.reporter, edge.target): edge.transform for edge in told(team)}
    back = own.get((pair[1], pair[0]))
    candidates = [own.get(pair), None if back is None else back.inverse()]
    return any(each is not None and not _differ(each, wrong) for each in candidates)


def _differ(first: Pose, second: Pose) -> bool:
    return math.hypot(first.x - second.x, first.y - second.y) > WRONG_M or rotation_between(first, second) > WRONG_RAD


def _placements(team: MetTeam) -> List[bool]:
    """Of each placement in the team whether it is right."""
    return [
        not _differ(transform, team.truth[name, robot])
        for name, agent in team.agents.items()
        for robot, transform in agent.view.transforms().items()
    ]


def rows_of(teams: Sequence[Injection], couples: Sequence[Injection], command: str) -> List[Row]:
    """Rows of the bar for teams of four, and of teams of two, where nothing but their walls can tell."""
    cycles = [each for each in teams if each.cycle]
    whole = sum(each.placed == ROBOTS * (ROBOTS - 1) for each in cycles)
    detail = (
        f"{sum(each.placed for each in teams)} of {len(teams) * ROBOTS * (ROBOTS - 1)} placements in all teams; where "
        f"the wrong transform took the place of the only bond, its two parts must meet again; {command}"
    )
    what = "the same, every robot placed right everywhere a minute after the injection"
    return [
        _gone_row("wrong transform gone on every robot within 30 s, teams of four", teams, command),
        _gone_row("the same, in a cycle of own transforms", cycles, command),
        row(what, f"{len(cycles)} of {len(cycles)}", whole, "teams", whole == len(cycles), detail),
        _gone_row("wrong transform gone on both robots within 30 s, teams of two", couples, command),
    ]


def _gone_row(what: str, injections: Sequence[Injection], command: str) -> Row:
    times = sorted(math.inf if each.gone is None else each.gone for each in injections)
    within = sum(time <= BAR_S for time in times)
    shown = f"median {times[len(times) // 2]:.1f} s, slowest {times[-1]:.1f} s" if times else "none"
    both = sum(each.both for each in injections)
    detail = f"{shown}; {both} with both robots misled; more wall than a right one; maps that grow; {command}"
    return row(what, f"{len(times)} of {len(times)}", within, "teams", within == len(times), detail)
