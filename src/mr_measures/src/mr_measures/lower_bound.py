"""What no team could beat, computed from the world alone: a bound on coverage over time and one on the time for all.

A robot of speed v sees a cell only from a place from which the cell is in line of sight and within the range of its
laser; call these places the *view* of the cell. Two bounds follow.

- **Coverage over time.** What a team has seen by time t has in its view a place within a driving distance of v t of
  some start. The share of such cells bounds the coverage.
- **Time to see everything.** Take some cells, the *witnesses*. A team that has seen them has been in all their views:
  each robot in some of them, in some order, driving at least the distance from its start to the first view and from
  each view to the next. Sharing the witnesses out among the robots and ordering them in the best way leaves a longest
  chain, and no team sees everything before this chain is driven. That holds for any witnesses; they are chosen such
  that their views are small and apart from each other.

There is no bound on the area seen per metre: behind a corner any area can come into view at once.

Everything that has to be approximated errs to the favour of the robots (`visibility`): they turn at once, look all
around, are as small as the disc in their footprint, keep their highest speed, know where to go and share all they see.
What remains is that coverage is computed on a regular sample of the reference cells, and that a map which is wrong may
claim cells that nobody has seen.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Sequence

import numpy as np

from mr_grid import Pose
from mr_measures.true_world import TrueWorld
from mr_measures.truth import Truth
from mr_measures.visibility import DrivingDistance, Views

SAMPLES = 2000  # reference cells looked at
MAXIMUM_WITNESSES = 11  # every way to share them out is tried
THUMBNAIL = 10_000  # cells at which views are compared; this only chooses witnesses


class LowerBound:
    """Bounds for teams in one world, with the sensors, footprints and speeds of its robots. Takes seconds."""

    def __init__(self, world: TrueWorld, speed_limit: float = math.inf, samples: int = SAMPLES) -> None:
        """`speed_limit`: m/s that their navigation asks for at most. ValueError for a world without reference cells."""
        reference = Truth.of_world(world).reference
        if not len(reference):
            raise ValueError("the world has no reference cells: no robot can move in it")
        self.points = reference[:: max(1, len(reference) // samples)]
        self.speed = min(max(robot.top_speed for robot in world.robots), speed_limit)
        self._driving = DrivingDistance(world)
        views = Views(world, self._driving.lattice)
        self._views = [views.of_point(point) for point in self.points]
        self._witnesses = self._choose_witnesses()
        self._between = self._distances_between_witnesses()
        self._sights: dict[Pose, np.ndarray] = {}

    def coverage(self, starts: Sequence[Pose], times: np.ndarray) -> np.ndarray:
        """Highest share (N,) of the reference cells that robots from these poses can have seen by `times` (N,) in s."""
        sight = np.sort(self._team_sight(starts))
        seen = np.searchsorted(sight, self.speed * np.asarray(times, dtype=float), side="right")
        return seen / len(sight)

    def completion_time(self, starts: Sequence[Pose]) -> float:
        """Least time in s after which the team can have seen everything that can be seen."""
        sight = self._team_sight(starts)
        longest = np.where(np.arange(2 ** len(self._witnesses)) > 0, np.inf, 0.0)
        for start in starts:
            alone = shortest_chains(self._sight(start)[self._witnesses], self._between)
            longest = shared_out(longest, alone)
        return max(float(sight[np.isfinite(sight)].max(initial=0.0)), float(longest[-1])) / self.speed

    def _team_sight(self, starts: Sequence[Pose]) -> np.ndarray:
        """Least distance (N,) in m that a robot of the team drives before it sees each sample."""
        return np.min([self._sight(start) for start in starts], axis=0)

    def _sight(self, start: Pose) -> np.ndarray:
        if start not in self._sights:
            field = self._driving.from_start(start)
            self._sights[start] = np.array([view.least(field) for view in self._views])
        return self._sights[start]

    def _choose_witnesses(self) -> np.ndarray:
        """Indices (M,) of samples with small views apart from each other."""
        thumbnails = self._thumbnails()
        taken = np.zeros(thumbnails.shape[1], dtype=bool)
        witnesses: list[int] = []
        for candidate in np.argsort(thumbnails.sum(axis=1), kind="stable"):
            view = thumbnails[candidate]
            if len(witnesses) < MAXIMUM_WITNESSES and view.any() and not (view & taken).any():
                witnesses.append(int(candidate))
                taken |= view
        return np.array(witnesses, dtype=int)

    def _thumbnails(self) -> np.ndarray:
        """Views (N, cells) of all samples, bool, at a coarse resolution."""
        rows, columns = self._driving.lattice.shape
        stride = max(1, round((rows * columns / THUMBNAIL) ** 0.5))
        return np.array([view.whole((rows, columns))[::stride, ::stride].ravel() for view in self._views])

    def _distances_between_witnesses(self) -> np.ndarray:
        """Least driving distances (M, M) in m between the views of the witnesses."""
        views = [self._views[witness] for witness in self._witnesses]
        fields = [self._driving.from_views(view.whole(self._driving.lattice.shape)) for view in views]
        return np.array([[view.least(field) for view in views] for field in fields])


def shortest_chains(entry: np.ndarray, between: np.ndarray) -> np.ndarray:
    """Length (2^M,) of the shortest chain from a start through each set of M places (Held and Karp).

    `entry`: (M,) from the start to each place; `between`: (M, M). Bit i of an index: whether place i is in the set.
    """
    count = len(entry)
    ending = np.full((2**count, count), np.inf)  # shortest chain through a set that ends in a place of it
    lengths = np.zeros(2**count)
    for chosen in range(1, 2**count):
        for last in (place for place in range(count) if chosen >> place & 1):
            rest = chosen ^ 1 << last
            ending[chosen, last] = (ending[rest] + between[:, last]).min() if rest else entry[last]
        lengths[chosen] = ending[chosen].min()
    return lengths


def shared_out(team: np.ndarray, alone: np.ndarray) -> np.ndarray:
    """Longest chain (2^M,) when each set is shared out between a team and one more robot as well as can be."""
    best = np.empty_like(team)
    for chosen in range(len(team)):
        parts = _parts(chosen)
        best[chosen] = np.maximum(team[parts ^ chosen], alone[parts]).min()
    return best


@lru_cache(maxsize=None)
def _parts(chosen: int) -> np.ndarray:
    """All subsets of a set given by its bits."""
    parts, part = [0], chosen
    while part:
        parts.append(part)
        part = part - 1 & chosen
    return np.array(parts)
