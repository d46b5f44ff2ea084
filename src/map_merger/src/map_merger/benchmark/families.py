"""The pairs of the benchmark: which buildings, where the robots start, how they map."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple, Optional, Tuple

import numpy as np

from mr_grid import OccupancyGrid, Pose

from ..registration import ranked_by_evidence
from ..search import candidates
from ..surface import Landmarks, landmarks_of
from ..synthetic import KINDS, FloorPlan, Pair, RobotMap, Survey, Surveyor, pair_of, rearranged
from ..transform import displacement, rotation_between
from .outcome import best_rigid_fit, overlap, shared_wall

STAGES = (0.4, 0.6, 0.8, 1.0)
"""Shares of the paths after which the robots exchange maps and look for the transform."""
DRIFTS_M = (0.0, 0.02, 0.05)
ALIAS_SHARE = 0.9
"""A transform that scores this share of what the true one does makes a pair a self-alias..."""
ALIAS_LEAST_M = 4.0
"""...if it scores as much as this, so that pairs which share nothing are none."""


@dataclass(frozen=True)
class Family:
    """Pairs from one kind of building. `moved`: share of the furniture that stands elsewhere for the second robot.
    `at_a_copy`: it starts where it sees an exact copy of what the first robot sees. Lengths of the building in m."""

    name: str
    kind: str
    moved: float = 0.0
    at_a_copy: bool = False
    shortest: float = 18.0
    longest: float = 45.0


FAMILIES = (
    Family("offices", "offices"),
    Family("offices, large", "offices", shortest=45.0, longest=100.0),
    Family("rooms equal but for furniture", "furnished_rooms"),
    Family("halls", "halls"),
    Family("corridors", "corridors"),
    Family("loops", "loops"),
    Family("caves", "caves"),
    Family("moved furniture", "offices", moved=0.4),
    Family("clutter", "clutter"),
    Family("clutter, moved", "clutter", moved=0.3),
    Family("equal rooms", "equal_rooms"),
    Family("equal rooms, at a copy", "equal_rooms", at_a_copy=True),
    Family("turned copies, at a copy", "turned_copies", at_a_copy=True),
    Family("bare equal rooms, at a copy", "bare_rooms", at_a_copy=True),
    Family("symmetric building, at the image", "symmetric", at_a_copy=True),
    Family("long bare corridor, at a copy", "long_corridor", at_a_copy=True),
)


class Case(NamedTuple):
    """A pair to be measured: the growing maps, the true transform source -> target of the last ones (best rigid fit),
    shared wall (m), whether another transform fits the undistorted maps as well, and what it was drawn from."""

    seed: int
    family: str
    target: Tuple[OccupancyGrid, ...]
    source: Tuple[OccupancyGrid, ...]
    truth: Pose
    shared: float
    alias: bool
    drift: float

    def overlap(self) -> np.ndarray:
        """Points (n, 2; m) of the source over which errors are taken."""
        return overlap(self.target[-1], self.source[-1], self.truth)


def family_of(seed: int) -> Family:
    """The families take turns."""
    return FAMILIES[seed % len(FAMILIES)]


def draw_case(seed: int, family: Optional[Family] = None) -> Case:
    """The pair of a seed."""
    family = family or family_of(seed)
    random = np.random.default_rng([seed, 14])
    plan = KINDS[family.kind](random, random.uniform(family.shortest, family.longest))
    survey = Survey(
        path_length=_path_length(random),
        drift=DRIFTS_M[int(random.integers(len(DRIFTS_M)))],
        smudges=int(random.integers(0, 3)),
        range_noise=float(random.choice([0.01, 0.03])),
        stages=STAGES,
    )
    first = Surveyor(plan)
    second = first if family.moved == 0.0 else Surveyor(rearranged(plan, random, family.moved))
    target = first.explore(random, survey, yaw=_heading(random))
    start = _start(random, family, plan, target.path[0, :2])
    survey = replace(survey, path_length=_path_length(random))
    source = second.explore(random, survey, start=start, yaw=_heading(random))
    return _case(seed, family, pair_of(target, source), survey.drift, _undistorted(random, first, target, source))


def _path_length(random: np.random.Generator) -> float:
    return float(math.exp(random.uniform(math.log(1.5), math.log(45.0))))


def _heading(random: np.random.Generator) -> float:
    return float(random.uniform(-math.pi, math.pi))


def _start(
    random: np.random.Generator, family: Family, plan: FloorPlan, place: np.ndarray
) -> Optional[Tuple[float, float]]:
    """Where the second robot starts: at a copy, beside the first one, within 10 m of it, or (None) anywhere."""
    if family.at_a_copy:
        return _copy_of(random, plan, place)
    farthest = random.choice([0.0, 1.5, 10.0, math.inf], p=[0.1, 0.25, 0.4, 0.25])
    if math.isinf(farthest):
        return None
    shift = random.uniform(-farthest, farthest, 2)
    return float(place[0] + shift[0]), float(place[1] + shift[1])


def _copy_of(random: np.random.Generator, plan: FloorPlan, place: np.ndarray) -> Tuple[float, float]:
    """Another place of the building that looks the same; the place itself if there is none."""
    aliases = [Pose(*alias) for alias in plan.aliases]
    motions = [motion for alias in aliases for motion in (alias, alias.inverse())]
    places = [motion.apply(place[None])[0] for motion in motions]
    copies = [each for each in places if plan.holds(each)] or [place]
    x, y = copies[int(random.integers(len(copies)))]
    return float(x), float(y)


def _undistorted(random: np.random.Generator, surveyor: Surveyor, target: RobotMap, source: RobotMap) -> Pair:
    ideal = Survey(range_noise=0.0)
    return pair_of(*(surveyor.drawn(random, ideal, robot.path) for robot in (target, source)))


def _case(seed: int, family: Family, pair: Pair, drift: float, ideal: Pair) -> Case:
    target, source = landmarks_of(pair.target.grid), landmarks_of(pair.source.grid)
    truth = best_rigid_fit(target, source, pair.truth)
    shared = shared_wall(pair.target.grid, pair.source.grid, truth)
    alias = self_alias(landmarks_of(ideal.target.grid), landmarks_of(ideal.source.grid), ideal.truth)
    return Case(seed, family.name, pair.target.stages, pair.source.stages, truth, shared, alias, drift)


def self_alias(target: Landmarks, source: Landmarks, truth: Pose) -> bool:
    """True if a transform that differs from the truth by more than 0.5 m or 4 deg scores within a tenth of it."""
    starts = [truth] + [candidate.transform for candidate in candidates(target, source, 16)]
    ranked = ranked_by_evidence(target, source, starts)
    points = source.surface.points
    true_score = max((evidence.score for evidence, found in ranked if _same(found, truth, points)), default=0.0)
    others = [evidence.score for evidence, found in ranked if not _same(found, truth, points)]
    return max(others, default=0.0) >= max(ALIAS_LEAST_M, ALIAS_SHARE * true_score)


def _same(first: Pose, second: Pose, points: np.ndarray) -> bool:
    return (
        rotation_between(first, second) <= math.radians(4.0)
        and float(np.median(displacement(first, second, points))) <= 0.5
    )
