"""Sightings and walls together: which transform of the sightings can be believed, and how exact it is.

Sightings say who is where, to a few centimetres and a degree. Walls, however few, refine that, and refute what was
mistaken. Where there are none, as in an open hall, a long way seen is enough by itself.
"""

import math
from typing import NamedTuple, Sequence, Tuple

import numpy as np

from mr_grid import Pose, normalized

from ..evidence import Evidence, compare
from ..registration import UNLIMITED, Limits, Registration, Verdict
from ..surface import Landmarks, Surface, subsample
from .doubts import doubts_of
from .values import Hypothesis

LARGEST_SHIFT_M = 0.25
LARGEST_TURN = math.radians(2.0)
_CERTAINTY = 2.5
"""Bounds of the error anywhere in the overlap, and how many standard deviations must lie within."""
_REACHES = (0.35, 0.3, 0.25, 0.2, 0.15, 0.12)
_WALL_DEVIATION_M = 0.05
_WALL_LENGTH_M = 0.5
"""Standard deviation of a wall's place, and the length of wall that has an error of its own."""
_COMMON_ERROR = np.diag([0.02**2, 0.02**2, math.radians(0.3) ** 2])
"""Covariance of what all sightings have in common: where the laser says that a body's middle is, and delays."""
_MOST_POINTS = 1200
_AGAINST_M = 1.0
_AGAINST_SHARE = 0.08
_OPEN_M = 4.0
"""Distance in m from the place of the meeting for which an answer without shared walls must hold."""
_STRAYED = 4.0
"""Standard deviations by which walls may move what the sightings say."""


class Confirmation(NamedTuple):
    """registration: the decision. covariance: float (3, 3) of x, y, yaw of its transform, with the rotation about
    `centre` (m, in the source's frame). words: the reason, with numbers, while it is not accepted."""

    registration: Registration
    covariance: np.ndarray
    centre: Tuple[float, float]
    words: str

    def covariance_at_origin(self) -> np.ndarray:
        """Covariance (3, 3) of the transform's own x, y (m) and yaw (rad)."""
        if self.registration.transform is None:
            return self.covariance
        arm_x, arm_y = Pose(yaw=self.registration.transform.yaw).apply_point(-self.centre[0], -self.centre[1])
        carried = np.array([[1.0, 0.0, -arm_y], [0.0, 1.0, arm_x], [0.0, 0.0, 1.0]])
        return carried @ self.covariance @ carried.T


class _Judged(NamedTuple):
    hypothesis: Hypothesis
    transform: Pose
    covariance: np.ndarray
    evidence: Evidence
    reach: float


NOTHING = Confirmation(Registration(Verdict.NO_CANDIDATE), np.zeros((3, 3)), (0.0, 0.0), "not seen")


def confirmed(
    target: Landmarks, source: Landmarks, hypotheses: Sequence[Hypothesis], limits: Limits = UNLIMITED
) -> Confirmation:
    """Decides on hypotheses for the transform source -> target, ranked by the sightings."""
    if not hypotheses:
        return NOTHING
    judged = [_judged(target, source, each) for each in hypotheses]
    left = [each for each in judged if not _contradicted(each.evidence)]
    if not left:
        return _result(judged[0], Verdict.CONTRADICTED, _words_of_contradiction(judged[0].evidence))
    best = left[0]
    doubts = doubts_of([each.hypothesis for each in left])
    if doubts:
        return _result(best, Verdict.AMBIGUOUS if best.hypothesis.settled else Verdict.UNSETTLED, doubts)
    doubts = _inexact(best)
    if doubts:
        return _result(best, Verdict.INEXACT, doubts)
    if not limits.allow(best.transform):
        return _result(best, Verdict.BEYOND_LIMITS, Verdict.BEYOND_LIMITS.value)
    return _result(best, Verdict.ACCEPTED, "")


def _judged(target: Landmarks, source: Landmarks, hypothesis: Hypothesis) -> _Judged:
    transform, covariance, reach = _with_walls(target.surface, source.surface, hypothesis)
    return _Judged(hypothesis, transform, covariance, compare(target, source, transform), reach)


def _contradicted(evidence: Evidence) -> bool:
    return evidence.against >= _AGAINST_M and evidence.conflict > _AGAINST_SHARE


def _words_of_contradiction(evidence: Evidence) -> str:
    return f"{evidence.against:.1f} m of wall in free space, {evidence.matched:.1f} m shared"


def _inexact(judged: _Judged) -> str:
    """Why the error may be too large somewhere in the overlap; '' if it is not."""
    turn = _CERTAINTY * math.sqrt(judged.covariance[2, 2])
    shift = _CERTAINTY * math.sqrt(float(np.linalg.eigvalsh(judged.covariance[:2, :2])[-1]))
    shift = math.hypot(shift, turn * judged.reach)
    if turn > LARGEST_TURN or shift > LARGEST_SHIFT_M:
        return f"known to {shift:.2f} m and {math.degrees(turn):.1f} deg only"
    return ""


def _result(judged: _Judged, verdict: Verdict, words: str) -> Confirmation:
    registration = Registration(verdict, judged.transform, judged.evidence, prior=True, met=verdict is Verdict.ACCEPTED)
    return Confirmation(registration, judged.covariance, judged.hypothesis.centre, words)


def _with_walls(target: Surface, source: Surface, hypothesis: Hypothesis) -> Tuple[Pose, np.ndarray, float]:
    """The most likely transform given the sightings (a normal distribution) and the walls (point to line), its
    covariance, and the distance in m from the centre of the hypothesis to the farthest shared wall."""
    sample = subsample(source, _MOST_POINTS)
    centre, start = np.array(hypothesis.centre), hypothesis.transform
    sighted = hypothesis.covariance + _COMMON_ERROR
    seen = np.linalg.inv(sighted)
    transform, information, reach = start, seen, _OPEN_M
    for distance in _REACHES:
        rows, offsets, far = _wall_equations(target, sample, transform, centre, distance)
        weight = sample.spacing / _WALL_LENGTH_M / _WALL_DEVIATION_M**2
        information = seen + weight * rows.T @ rows
        wanted = weight * rows.T @ offsets + seen @ _difference(start, transform, centre)
        transform = _moved(transform, np.linalg.solve(information, wanted), centre)
        reach = max(_OPEN_M, far)
    strayed = _difference(start, transform, centre)
    if float(strayed @ seen @ strayed) > _STRAYED**2:
        return start, sighted, reach
    return transform, np.linalg.inv(information), reach


def _wall_equations(
    target: Surface, source: Surface, transform: Pose, centre: np.ndarray, distance: float
) -> Tuple[np.ndarray, np.ndarray, float]:
    """Rows (n, 3) and right sides (n,) of the linear equations for the change of x, y at the centre and yaw that lays
    the source's walls on the target's; and how far from the centre they reach, m."""
    if not len(target.points) or not len(source.points):
        return np.zeros((0, 3)), np.zeros(0), 0.0
    points, normals = transform.apply(source.points), Pose(yaw=transform.yaw).apply(source.normals)
    nearest = target.index().nearest(points, normals, distance)
    paired = nearest >= 0
    points, nearest = points[paired], nearest[paired]
    if not len(points):
        return np.zeros((0, 3)), np.zeros(0), 0.0
    normals = target.normals[nearest]
    arms = points - transform.apply(centre[None])
    turning = normals[:, 1] * arms[:, 0] - normals[:, 0] * arms[:, 1]
    offsets = ((target.points[nearest] - points) * normals).sum(axis=1)
    return np.column_stack([normals, turning]), offsets, float(np.quantile(np.hypot(*arms.T), 0.98))


def _difference(wanted: Pose, transform: Pose, centre: np.ndarray) -> np.ndarray:
    """Change of (x, y, yaw), about the centre, from `transform` to `wanted`."""
    shift = wanted.apply(centre[None])[0] - transform.apply(centre[None])[0]
    return np.append(shift, normalized(wanted.yaw - transform.yaw))


def _moved(transform: Pose, change: np.ndarray, centre: np.ndarray) -> Pose:
    """The transform turned about the image of the centre, and shifted."""
    x, y = (transform.apply(centre[None])[0] + change[:2]).tolist()
    turned = Pose(yaw=normalized(transform.yaw + float(change[2])))
    back_x, back_y = turned.apply_point(*centre.tolist())
    return Pose(x - back_x, y - back_y, turned.yaw)
