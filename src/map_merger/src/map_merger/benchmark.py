"""Measures registration on pairs of partial maps: right, imprecise, wrong, declined.

Wrong: accepted, and off by more than 0.25 m anywhere in the overlap or 2 deg. Right: accepted, and the mean
displacement over the overlap is at most 0.1 m. Imprecise: between. Overlap: the source's known cells that the target
knows at the true transform.
Truth under distortion: the best rigid fit, which is the true transform refined on the shared walls.
"""

import math
import time
from dataclasses import dataclass, replace
from typing import Callable, Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from .alignment import Alignment
from .evidence import compare
from .grid import Grid, cell_centres, values_at
from .refine import FINE_REACH, refined
from .registration import Registration, Verdict, follow, judge_kept
from .surface import Landmarks, landmarks_of
from .synthetic import (
    FloorPlan,
    Pair,
    Survey,
    Surveyor,
    bare_rooms_plan,
    long_corridor_plan,
    office_plan,
    pair_of,
    symmetric_plan,
    turned_copies_plan,
)
from .transform import Transform, displacement, rotation_between

STAGES = (0.4, 0.6, 0.8, 1.0)
"""Shares of the paths after which the robots exchange maps and look for the transform."""
RIGHT_M = 0.1
WRONG_M = 0.25
WRONG_RAD = math.radians(2.0)

Register = Callable[[Landmarks, Landmarks], Registration]


@dataclass(frozen=True)
class Scenario:
    """A family of pairs: how far apart the robots start (m), how they map, in which building."""

    name: str
    plan: Callable[[np.random.Generator], FloorPlan]
    distance: float
    longest_path: float = 25.0
    drift: float = 0.0
    smudges: int = 0
    range_noise: float = 0.01
    same_heading: bool = False
    overlapping: bool = True
    """False: in this family only "wrong = 0" is asked, since rooms repeat or the maps need not overlap."""
    at_a_copy: bool = False
    """The source starts where it sees an exact copy of what the target sees: the hardest case of repeated rooms."""


class Outcome(NamedTuple):
    """One pair, measured. `shared` is the wall in metres that both maps hold, `seconds` the CPU time of the
    registration."""

    seed: int
    kind: str
    reason: str
    mean_error: float
    largest_error: float
    rotation_error: float
    shared: float
    seconds: float


def scenarios(plan: Optional[FloorPlan] = None) -> List[Scenario]:
    """The families of the benchmark; `plan` replaces the generated office where rooms need not repeat exactly."""

    def office(random: np.random.Generator) -> FloorPlan:
        return plan if plan is not None else office_plan(random)

    def copies(random: np.random.Generator) -> FloorPlan:
        return office_plan(random, same=True)

    def alias(name: str, plan: Callable[[np.random.Generator], FloorPlan], **changes: float) -> Scenario:
        return Scenario(name, plan, math.inf, overlapping=False, at_a_copy=True, **changes)  # type: ignore[arg-type]

    return [
        Scenario("side by side, same heading", office, 1.5, same_heading=True, longest_path=20.0),
        Scenario("near, any heading", office, 5.0),
        Scenario("near, noise, drift, smudges", office, 5.0, drift=0.08, smudges=4, range_noise=0.03),
        Scenario("anywhere in the building", office, math.inf, overlapping=False),
        Scenario("anywhere, long paths", office, math.inf, longest_path=60.0, overlapping=False),
        Scenario("identical rooms, near", copies, 5.0, overlapping=False),
        Scenario("identical rooms, anywhere", copies, math.inf, overlapping=False),
        Scenario("identical rooms, anywhere, drift", copies, math.inf, drift=0.08, smudges=4, overlapping=False),
        alias("identical rooms, at a copy", copies),
        alias("identical rooms, at a copy, drift", copies, drift=0.08, smudges=4, range_noise=0.03),
        alias("turned copies, at a copy", turned_copies_plan),
        alias("bare equal rooms, at a copy", bare_rooms_plan),
        alias("symmetric building, at the image", symmetric_plan),
        alias("long bare corridor, at a copy", long_corridor_plan),
        Scenario("long bare corridor, anywhere", long_corridor_plan, math.inf, overlapping=False),
    ]


def draw_pair(scenario: Scenario, seed: int) -> Pair:
    """The pair of a seed."""
    random = np.random.default_rng(seed)
    surveyor = Surveyor(scenario.plan(random))
    survey = Survey(
        path_length=float(random.uniform(1.0, scenario.longest_path)),
        drift=scenario.drift,
        smudges=scenario.smudges,
        range_noise=scenario.range_noise,
        stages=STAGES,
    )
    heading = float(random.uniform(-math.pi, math.pi))
    target = surveyor.explore(random, survey, yaw=heading if scenario.same_heading else None)
    place: Optional[Tuple[float, float]] = None
    if math.isfinite(scenario.distance):
        shift = random.uniform(-scenario.distance, scenario.distance, 2)
        place = (float(target.path[0, 0] + shift[0]), float(target.path[0, 1] + shift[1]))
    if scenario.at_a_copy:
        place = _place_of_a_copy(random, surveyor.plan, target.path[0, :2])
    survey = replace(survey, path_length=float(random.uniform(1.0, scenario.longest_path)))
    source = surveyor.explore(random, survey, start=place, yaw=heading if scenario.same_heading else None)
    return pair_of(target, source)


def _place_of_a_copy(random: np.random.Generator, plan: FloorPlan, place: np.ndarray) -> Tuple[float, float]:
    """Another place of the building that looks the same; the place itself if there is none."""
    motions = [motion for alias in plan.aliases for motion in (alias, alias.inverse())]
    places = [motion.apply(place[None])[0] for motion in motions]
    copies = [each for each in places if plan.holds(each)] or [place]
    x, y = copies[int(random.integers(len(copies)))]
    return float(x), float(y)


def measure(pair: Pair, seed: int, register: Register) -> Outcome:
    """Lets the agents' rules decide on the growing pair, as during a mission, and compares with the truth."""
    alignment = Alignment()
    seconds = []
    result = Registration(Verdict.NO_CANDIDATE)
    for target_grid, source_grid in zip(pair.target.stages, pair.source.stages):
        target, source = landmarks_of(target_grid), landmarks_of(source_grid)
        began = time.process_time()
        if alignment.transform is None:
            result = register(target, source)
        else:
            better, evidence = follow(target, source, alignment.transform)
            result = Registration(judge_kept(evidence), better, evidence)
        seconds.append(time.process_time() - began)
        alignment.finished(result)
    truth = best_rigid_fit(target, source, pair.truth)
    shared = compare(target, source, truth).matched
    spent = float(np.mean(seconds))
    if alignment.transform is None:
        return Outcome(seed, "declined", _reason(result), math.inf, math.inf, math.inf, shared, spent)
    error = displacement(truth, alignment.transform, overlap(pair.target.grid, pair.source.grid, truth))
    rotation = rotation_between(truth, alignment.transform)
    return Outcome(
        seed,
        classify(error, rotation),
        result.verdict.value,
        float(error.mean()),
        float(error.max()),
        rotation,
        shared,
        spent,
    )


def _reason(result: Registration) -> str:
    return "not confirmed" if result.accepted else result.verdict.value


def classify(error: np.ndarray, rotation: float) -> str:
    """Kind of an accepted transform from its displacement (m) over the overlap and its rotation error (rad)."""
    if error.max() > WRONG_M or rotation > WRONG_RAD:
        return "wrong"
    return "right" if error.mean() <= RIGHT_M else "imprecise"


def best_rigid_fit(target: Landmarks, source: Landmarks, truth: Transform) -> Transform:
    """The truth for distorted maps: refined on the shared walls, but never led away by more than a little."""
    fitted = refined(target.surface, source.surface, truth, FINE_REACH)
    moved = displacement(truth, fitted, source.surface.points).max() if len(source.surface.points) else 0.0
    return fitted if moved < 0.3 and compare(target, source, truth).matched > 3.0 else truth


def overlap(target: Grid, source: Grid, truth: Transform) -> np.ndarray:
    """Points (n, 2) of the source that both maps know; all known ones if there are none."""
    rows, columns = np.nonzero(source.cells[::3, ::3] >= 0)
    points = cell_centres(source.info, 3 * rows, 3 * columns)
    shared = values_at(target.cells, target.info, truth.apply(points), -1) >= 0
    return points[shared] if shared.any() else points


def counts(outcomes: List[Outcome]) -> Dict[str, int]:
    """How many outcomes of each kind."""
    return {
        kind: sum(outcome.kind == kind for outcome in outcomes) for kind in ("right", "imprecise", "wrong", "declined")
    }
