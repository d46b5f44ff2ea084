"""The answers that are compared: two maps alone, with a rough prior, the agents' rule over growing maps, features."""

import math
import time
from typing import Callable, Dict, Optional, Tuple

import numpy as np

from mr_grid import UNKNOWN, OccupancyGrid, Pose

from .. import features, registration
from ..alignment import Alignment
from ..one_shot import decide, sure
from ..registration import Prior, Registration, Verdict, follow, judge_kept
from ..surface import landmarks_of
from .families import Case
from .outcome import Outcome, outcome_of

PRIOR_M, PRIOR_RAD = 2.0, math.radians(20.0)
"""A rough prior is uniformly within this of the truth, per axis, taken at the middle of the known area."""

Answer = Tuple[Optional[Pose], str]
Rule = Callable[[Case], Answer]


def once(case: Case) -> Answer:
    """Two maps and nothing else, as on the command line."""
    return _answer(decide(landmarks_of(case.target[-1]), landmarks_of(case.source[-1])))


def once_sure(case: Case) -> Answer:
    """The same, but only what copies hardly ever fake."""
    result = decide(landmarks_of(case.target[-1]), landmarks_of(case.source[-1]))
    return (result.transform, "sure") if sure(result) else (None, "not sure")


def once_with_prior(case: Case) -> Answer:
    """Two maps and a rough prior."""
    return _answer(decide(landmarks_of(case.target[-1]), landmarks_of(case.source[-1]), rough_prior(case)))


def agents(case: Case) -> Answer:
    """The agents' rule on the growing maps, without sightings and without prior."""
    alignment = Alignment()
    result = Registration(Verdict.NO_CANDIDATE)
    for target_grid, source_grid in zip(case.target, case.source):
        target, source = landmarks_of(target_grid), landmarks_of(source_grid)
        if alignment.transform is None:
            result = registration.register(target, source)
        else:
            better, evidence = follow(target, source, alignment.transform)
            result = Registration(judge_kept(evidence), better, evidence)
        alignment.finished(result)
    reason = "not confirmed" if result.accepted and alignment.transform is None else result.verdict.value
    return alignment.transform, reason


def walls_alone(case: Case) -> Answer:
    """The last maps by what agents may believe of walls alone."""
    result = registration.register(landmarks_of(case.target[-1]), landmarks_of(case.source[-1]))
    reason = "not enough for walls alone" if result.accepted else result.verdict.value
    return (result.transform if registration.believed_alone(result) else None), reason


def orb(case: Case) -> Answer:
    """The paper's method: a similarity transform from ORB features is taken if its scale is near 1."""
    return _estimated(case, features.orb())


def akaze(case: Case) -> Answer:
    """The same from AKAZE features."""
    return _estimated(case, features.akaze())


def verified_orb(case: Case) -> Answer:
    """ORB proposes, the walls decide."""
    target, source = landmarks_of(case.target[-1]), landmarks_of(case.source[-1])
    return _answer(features.register(target, source))


RULES: Dict[str, Rule] = {
    "two maps": once,
    "two maps, rough prior": once_with_prior,
    "two maps, sure": once_sure,
    "agents, no sighting": agents,
    "walls alone": walls_alone,
    "ORB": orb,
    "ORB, verified": verified_orb,
    "AKAZE": akaze,
}


def measured(rule: Rule, case: Case) -> Outcome:
    """What became of the case under the rule."""
    began = time.process_time()
    transform, reason = rule(case)
    seconds = time.process_time() - began
    return outcome_of(transform, case.truth, case.overlap(), reason, seconds)


def rough_prior(case: Case) -> Prior:
    """A prior as somebody gives it who knows roughly where the robots are; the same for the same case."""
    random = np.random.default_rng([case.seed, 3])
    x, y, yaw = random.uniform(-1.0, 1.0, 3) * (PRIOR_M, PRIOR_M, PRIOR_RAD)
    centre = known_centre(case.source[-1])
    there = case.truth.apply(centre[None])[0]
    turned = Pose(0.0, 0.0, case.truth.yaw + yaw)
    shift = there + np.array([x, y]) - turned.apply(centre[None])[0]
    return Prior(Pose(float(shift[0]), float(shift[1]), turned.yaw), math.hypot(PRIOR_M, PRIOR_M), PRIOR_RAD)


def known_centre(grid: OccupancyGrid) -> np.ndarray:
    """Middle of the known cells, (2,), m."""
    return grid.info.centres(*np.nonzero(grid.cells != UNKNOWN)).mean(axis=0)


def _answer(result: Registration) -> Answer:
    return (result.transform if result.accepted else None), result.verdict.value


def _estimated(case: Case, detector: features.Detector) -> Answer:
    found = features.estimates(case.target[-1], case.source[-1], detector, 1)
    return (found[0] if found else None), "scale near 1" if found else "no estimate with a scale near 1"
