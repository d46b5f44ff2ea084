"""What was decided about frontier points: visited, given up, to be tried later. The rules and their state."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Callable, Dict, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from explorer.frontiers import THINNING_DISTANCE, Frontier
from explorer.heard import Heard, KnownArea
from explorer.places import Places
from explorer.statement import MOST_VERDICTS, Decided, Kind
from explorer.told import ToldPlaces

LOOK_PATIENCE = 8.0  # s that a look waits at most for a map that was made after it
LOOKS = 2  # times a frontier is looked at before it counts as visited; one is enough if it shows nothing new
NEW_AREA = 0.2  # m^2 of known area more around a frontier that make it worth another look
TRY_DISTANCE = 0.5  # m, frontiers this near to one that failed have failed with it
RETRY_TIME = 8.0  # s after which a frontier that failed is tried again
RETRY_TIME_BLOCKED = 4.0  # s, the same behind a robot
BLOCKED_TRIES = 3  # failures behind a robot that count as one: it may have come to stay
FAILURES = 2  # that give a frontier up
REVIVALS = 3  # times a frontier that was given up is tried anew
CHANGED_CELLS = 20  # known cells more or less around a frontier that make a new map of it
TOLD_TIME = 8.0  # s that the merged map needs to show what another robot has explored

# Points that were given up or visited, kept so that a point found there anew inherits the verdict.
MAXIMUM_SPOTS = 2000

KnownNear = Callable[[float, float], int]
"""Number of known cells of the map near a point in metres."""


@dataclass(frozen=True)
class Verdict:
    """On the frontier point at (x, y), metres in the own map frame.

    `visited`: it was looked at from close by and is still there, so it is no longer a goal. `failures` counts the goals
    that failed, `blocked` those that failed behind another robot. Until `retry_at`, in seconds, it is not tried again.
    `looked_at`: time in seconds of a look of which no map shows yet what it has seen, `aimed`: it was taken from the
    viewpoint for this point; `area`: m^2 known around it then. `known`: number of cells known around it when it was
    visited or given up.
    """

    x: float
    y: float
    visited: bool = False
    given_up: bool = False
    failures: int = 0
    blocked: int = 0
    retry_at: float = -math.inf
    looked_at: float = -math.inf
    aimed: bool = False
    area: float = 0.0
    looks: int = 0
    known: Optional[int] = None
    revivals: int = 0

    @property
    def is_goal(self) -> bool:
        return not (self.visited or self.given_up)

    @cached_property
    def ready_at(self) -> float:
        """Time in seconds from which on it can be tried."""
        return max(self.retry_at, self.looked_at + LOOK_PATIENCE) if self.is_goal else math.inf

    def awaits_map(self, now: float) -> bool:
        """True while a map that shows what was looked at is still to come."""
        return now < self.looked_at + LOOK_PATIENCE

    def inherited_at(self, x: float, y: float) -> "Verdict":
        """Of a point found anew beside this one."""
        return replace(self, x=x, y=y, looked_at=-math.inf, looks=0)


class Ready(NamedTuple):
    """Numbers of points that can be tried, from one time in seconds until another, as long as no verdict changes:
    `changes` as in `Verdicts`."""

    numbers: FrozenSet[int]
    since: float
    until: float
    changes: int

    def holds(self, verdicts: "Verdicts", now: float) -> bool:
        return self.changes == verdicts.changes and self.since <= now < self.until


class Verdicts:
    """Owner of all verdicts of one mission. A point keeps its verdict under its number while it is on the map, and by
    its place afterwards. `heard`: what other robots have decided. `revision` counts the changes of `decided`, `changes`
    those of any verdict."""

    def __init__(self) -> None:
        self._of: Dict[int, Verdict] = {}
        self._spots: Places[Verdict] = Places(MAXIMUM_SPOTS, THINNING_DISTANCE)
        self._told = ToldPlaces()
        self._cluster_failures: Dict[int, int] = {}
        self._looked_at = -math.inf  # s, the last look
        self.heard = Heard()
        self.revision = self.changes = 0

    def of(self, number: int) -> Verdict:
        """Of a point that is on the map."""
        return self._of[number]

    def is_goal(self, number: int) -> bool:
        return self._of[number].is_goal

    def ready(self, numbers: Iterable[int], now: float) -> "Ready":
        """Those of these points that can be tried now."""
        of = self._of
        times = [(of[number].ready_at, number) for number in numbers]
        until = min((time for time, _ in times if time > now), default=math.inf)
        return Ready(frozenset(number for time, number in times if time <= now), now, until, self.changes)

    def awaits_map(self, now: float) -> bool:
        """True while the map does not show yet what a look has seen."""
        return now < self._looked_at + LOOK_PATIENCE and any(verdict.awaits_map(now) for verdict in self._of.values())

    def given_up(self) -> int:
        return sum(verdict.given_up for verdict in self._of.values())

    def follow(self, new: Sequence[Frontier], gone: Sequence[Frontier]) -> None:
        """Takes the points that a new map shows, and those that it no longer does."""
        self.changes += 1
        for frontier in gone:
            verdict = self._of.pop(frontier.number)
            if not verdict.is_goal or verdict.revivals:
                self._spots.put(verdict.x, verdict.y, verdict)
        for frontier in new:
            spot = self._spots.near(frontier.x, frontier.y)
            fresh = Verdict(frontier.x, frontier.y)
            self._of[frontier.number] = fresh if spot is None else spot.inherited_at(frontier.x, frontier.y)

    def follow_clusters(self, alive: Iterable[int]) -> None:
        """Forgets the failures of clusters that are no more."""
        numbers = set(alive)
        self._cluster_failures = {n: count for n, count in self._cluster_failures.items() if n in numbers}

    # ---- looks ----------------------------------------------------------------------------------------------------

    def look(self, target: Optional[int], sees: Callable[[Verdict], bool], known_area: KnownArea, now: float) -> None:
        """The robot is where it can see its goal: what it sees now will be in the map soon."""
        for number, verdict in self._of.items():
            if verdict.visited or verdict.awaits_map(now):
                continue
            if number == target or sees(verdict):
                self._looked_at, area = now, known_area(verdict.x, verdict.y)
                looks = verdict.looks + 1
                self._put(number, replace(verdict, looks=looks, looked_at=now, aimed=number == target, area=area))

    def judge_looked(self, shown: float, known_near: KnownNear, known_area: KnownArea) -> bool:
        """`shown`: time in seconds up to which the map shows what the robot has seen. Looks before it end; a frontier
        that is still there counts as visited after several, or after one from its own viewpoint that has shown
        nothing new around it: leaving and coming back would show no more. True if there was one."""
        judged = False
        for number, verdict in self._of.items():
            if -math.inf < verdict.looked_at < shown:
                verdict = replace(verdict, looked_at=-math.inf)
                self._put(number, verdict)
                in_vain = verdict.aimed and known_area(verdict.x, verdict.y) - verdict.area <= NEW_AREA
                if (in_vain or verdict.looks >= LOOKS) and not verdict.visited:
                    self._put(number, replace(verdict, visited=True, known=known_near(verdict.x, verdict.y)))
                    judged = True
        self.revision += judged
        return judged

    # ---- failures -------------------------------------------------------------------------------------------------

    def fail(self, number: int, behind: Sequence[int], blocked: bool, known_near: KnownNear, now: float) -> None:
        """A goal for the frontier failed, and so would those for the points `behind` what is in the way. They are given
        up in the end; a robot in the way means further tries before."""
        failed, others = self._of[number], set(behind)
        for other, verdict in self._of.items():
            if other not in others and math.hypot(verdict.x - failed.x, verdict.y - failed.y) > TRY_DISTANCE:
                continue
            retry_at = now + (RETRY_TIME_BLOCKED if blocked else RETRY_TIME)
            verdict = replace(verdict, retry_at=retry_at, blocked=verdict.blocked + blocked)
            if not blocked or verdict.blocked % BLOCKED_TRIES == 0:
                verdict = replace(verdict, failures=verdict.failures + 1)
                if verdict.failures >= FAILURES:
                    verdict = _given_up(verdict, known_near)
                    self.revision += 1
            self._put(other, verdict)

    def fail_cluster(self, cluster: int, members: Iterable[int], limit: int, known_near: KnownNear) -> None:
        """A goal in a cluster failed; all its points are given up with the last of `limit` failures."""
        self._cluster_failures[cluster] = self._cluster_failures.get(cluster, 0) + 1
        if self._cluster_failures[cluster] >= limit:
            for number in members:
                self._put(number, _given_up(self._of[number], known_near))
            self.revision += 1

    def revive_changed(self, known_near: KnownNear) -> None:
        """Frontiers given up are goals again when the map around them has changed, a bounded number of times."""
        for number, verdict in self._of.items():
            if verdict.given_up and verdict.known is not None and verdict.revivals < REVIVALS:
                known = known_near(verdict.x, verdict.y)
                if abs(known - verdict.known) > CHANGED_CELLS:
                    self._put(number, _revived(verdict, failures=0))
                    self.revision += 1

    def revive_once(self) -> bool:
        """Before the end every frontier that was given up gets one more try; True if there was one."""
        again = False
        for number, verdict in self._of.items():
            if verdict.given_up and verdict.known is not None and verdict.revivals < 1:
                self._put(number, _revived(verdict, failures=1))
                again = True
        self.revision += again
        return again

    # ---- what other robots tell -----------------------------------------------------------------------------------

    def decided(self, cell_area: float) -> Tuple[Decided, ...]:
        """The own verdicts, the newest last, at most `MOST_VERDICTS`. `cell_area`: m^2 of a cell of the map."""
        verdicts = [*self._spots.values(), *self._of.values()]
        told = [(v, Kind.VISITED if v.visited else Kind.GIVEN_UP) for v in verdicts if not v.is_goal]
        newest = told[-MOST_VERDICTS:]
        return tuple(Decided(v.x, v.y, kind, (v.known or 0) * cell_area) for v, kind in newest)

    def believe_explored(self, robot: str, x: float, y: float, now: float) -> None:
        """A robot has explored this place, metres in the own frame: points there are no goals until the map had time to
        show it."""
        self._told.add(x, y, now + TOLD_TIME, robot)

    def told_expired(self, now: float) -> bool:
        """True if what was told is no longer believed since it was last asked for."""
        return self._told.expired(now)

    def told_places(self, now: float) -> Tuple[np.ndarray, List[str]]:
        """(n, 2) array in metres of the places that others have explored and the map need not show yet, and by whom."""
        return self._told.at(now)

    def _put(self, number: int, verdict: Verdict) -> None:
        self._of[number] = verdict
        self.changes += 1


def _given_up(verdict: Verdict, known_near: KnownNear) -> Verdict:
    if verdict.given_up:
        return verdict
    return replace(verdict, given_up=True, known=known_near(verdict.x, verdict.y))


def _revived(verdict: Verdict, failures: int) -> Verdict:
    return replace(verdict, given_up=False, failures=failures, revivals=verdict.revivals + 1)
