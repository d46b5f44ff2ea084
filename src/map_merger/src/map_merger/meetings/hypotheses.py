"""Which transforms between two robots' frames their sightings suggest, and what speaks for and against each."""

import math
from dataclasses import dataclass, field
from typing import List, Mapping, NamedTuple, Optional, Tuple

import numpy as np

from ..transform import Transform
from .fitting import Fits, Moments, covariance_of, fits_of, fitted, moments_of, transform_from
from .identity import is_empty, who_moves_alike, who_was_there
from .pairing import Pairs, paired
from .sweeps import NO_SWEEPS, Sweeps
from .tracking import Fragment, at_times
from .values import NO_SENSOR, UNMOVED, Hypothesis, Sensor

_DEVIATION_M = 0.05
"""Of a sighting: the laser sees surfaces, poses and times are not exact."""
_REACH_M = 0.15
"""A sighting farther from where it should be is of something else."""
_SEED_ERROR_M = 0.12
_SEED_SPREAD_M = 0.12
_MOST_SEEDS = 40
_MOST_CHECKED = 12
_MOST_KEPT = 6
_SAME_M = 0.25
_SAME_TURN = math.radians(10.0)
_FEWEST_AGREEING = 5
_UNSEEN_AT_LEAST = 10
_UNSEEN_SHARE = 0.2
_JUMP_SHARE = 0.5
_JUMP_RAD = math.radians(2.5)
"""Standard deviations where SLAM has jumped: of the place, as a share of the jump, and of the heading. In missions of
Turtlebots (seeds 1001 to 1004) jumps are 0.15 to 0.5 m, up to 9 deg; taken out of a track they leave 0.03 m, 4 deg."""
_VIEW_MARGIN = math.radians(15.0)
SHORTEST_PATH_M = 0.3
SHORTEST_BEND_M = 0.12
BEND_PER_ERROR = 10.0
"""A way that is a straight line to within so many times the error of the fit is like those of others. Ways of other
robots that began alike fit to within a fifth of their bend."""
LARGEST_ERROR_M = 0.04
SMALLEST_SHARE = 0.95
SHORTEST_SECONDS = 3.0
PROBATION_S = 1.5
"""A way must have been unmistakable for so long, in time of sightings, and must have agreed ever since."""
OUT_OF_SIGHT_S = 6.0
"""Or it must have been so long ago."""
FEWEST_SIGHTINGS = 10
FEWEST_OF_EACH = 3
"""Sightings on either side that make a straight drive unmistakable."""


@dataclass(frozen=True, eq=False)
class Sightings:
    """All that is known for the comparison of the own robot with another. Times are of the own clock.

    own, told: tracks (n, >= 3: time, x, y, ...) of the own robot and the other, each in its own frame; told also has
    the yaw. objects, told_objects: what each saw, in its own frame. sensor: the other's. others: tracks of the further
    robots that are heard, in their frames, as the other may be mistaken for them. placed: the believed ones of their
    transforms to the own frame. All tracks are free of jumps; jump: m by which both have jumped. own_map, told_map:
    from the frame of each robot's tracks to that of its map, in the mean.
    """

    robot: str
    own: np.ndarray
    told: np.ndarray
    objects: Tuple[Fragment, ...]
    told_objects: Tuple[Fragment, ...]
    sweeps: Sweeps
    sensor: Sensor = NO_SENSOR
    others: Mapping[str, np.ndarray] = field(default_factory=dict)
    placed: Mapping[str, Transform] = field(default_factory=dict)
    jump: float = 0.0
    own_map: Transform = UNMOVED
    told_map: Transform = UNMOVED

    def hypotheses(self) -> Tuple[Hypothesis, ...]:
        """The transforms that are not refuted, best supported first."""
        pairs = paired(self.told, self.objects, self.own, self.told_objects)
        found = [_support(pairs, turn, shift) for turn, shift in _seeds(pairs)]
        distinct = _distinct([each for each in found if each is not None], pairs)
        looks = _looks_of(self)
        checked = [each._replace(unseen=_unseen(self, pairs, each, looks)) for each in distinct if _stands(each, looks)]
        return tuple(_weighed(self, pairs, each) for each in checked[:_MOST_KEPT])


class _Support(NamedTuple):
    """A transform and the pairs that agree with it (bool (n,))."""

    turn: complex
    shift: complex
    agree: np.ndarray
    sightings: float
    error: float
    unseen: bool


def _seeds(pairs: Pairs) -> List[Tuple[complex, complex]]:
    """Transforms to begin with: from each fragment that has an extent, and from every two of both robots."""
    if not pairs.fragments:
        return []
    sums = moments_of(pairs.source, pairs.target, pairs.label, pairs.fragments)
    own, told = _part(sums, slice(0, pairs.own)), _part(sums, slice(pairs.own, None))
    both = Moments(*(mine[:, None] for mine in own)).plus(Moments(*(theirs[None, :] for theirs in told)))
    recent = _recent(pairs)
    seeds: List[Tuple[float, complex, complex]] = []
    for moments in (sums, both, recent):
        seeds += _usable(fits_of(moments), moments.weight)
    seeds.sort(key=lambda seed: seed[0])
    return [(turn, shift) for _, turn, shift in seeds[:_MOST_SEEDS]]


def _recent(pairs: Pairs, knots: int = 10) -> Moments:
    """Of the latest knots of each fragment: before, it may have followed something else."""
    rank = np.zeros(len(pairs.label), int)
    ends = np.append(np.flatnonzero(np.diff(pairs.label)), len(pairs.label) - 1)
    rank = ends[np.searchsorted(ends, np.arange(len(rank)))] - np.arange(len(rank))
    late = rank < knots
    return moments_of(pairs.source[late], pairs.target[late], pairs.label[late], pairs.fragments)


def _part(moments: Moments, part: slice) -> Moments:
    return Moments(*(values[part] for values in moments))


def _usable(fits: Fits, count: np.ndarray) -> List[Tuple[float, complex, complex]]:
    good = (fits.error < _SEED_ERROR_M) & (fits.spread > _SEED_SPREAD_M) & (count >= 2)
    uncertain = fits.error[good] / fits.spread[good]
    return list(zip(uncertain.tolist(), fits.turn[good].tolist(), fits.shift[good].tolist()))


def _support(pairs: Pairs, turn: complex, shift: complex) -> Optional[_Support]:
    """The transform fitted to all that agrees with it; None if next to nothing does."""
    agree = np.zeros(len(pairs.source), bool)
    for reach in (1.5 * _REACH_M, _REACH_M, _REACH_M):
        agree = np.abs(turn * pairs.source + shift - pairs.target) < reach
        if agree.sum() < 2:
            return None
        turn, shift = fitted(pairs.source[agree], pairs.target[agree])
    sightings = float(pairs.sightings[agree].sum())
    if sightings < _FEWEST_AGREEING:
        return None
    error = float(np.sqrt(np.mean(np.abs(turn * pairs.source + shift - pairs.target)[agree] ** 2)))
    return _Support(turn, shift, agree, sightings, error, False)


class _Looks(NamedTuple):
    """At the times of the own sweeps: where the other told that it was (complex (n,), its yaw (n,)) and where the own
    robot was, each in its own frame, and whether that is known."""

    sweeps: Sweeps
    told: np.ndarray
    yaw: np.ndarray
    told_known: np.ndarray
    own: np.ndarray
    own_known: np.ndarray


def _looks_of(sightings: Sightings) -> _Looks:
    times, told = sightings.sweeps.times, sightings.told
    yaw = np.zeros(len(times))
    if len(told):
        yaw = told[np.clip(np.searchsorted(told[:, 0], times), 0, len(told) - 1), 3]
    places, known = at_times(told, times)
    return _Looks(sightings.sweeps, places, yaw, known, *at_times(sightings.own, times))


def _stands(support: _Support, looks: _Looks) -> bool:
    """False if own scans show nothing where the other robot should be."""
    return not is_empty(looks.sweeps, support.turn * looks.told + support.shift, looks.told_known)


def _unseen(sightings: Sightings, pairs: Pairs, support: _Support, looks: _Looks) -> bool:
    """True if the other, with a free line of sight, sees nothing where the own robot should be."""
    if sightings.sensor.farthest <= 0.0:
        return False
    seen = looks.sweeps.look(support.turn * looks.told + support.shift, looks.told_known)
    should = looks.sweeps.times[seen.there & _in_view(sightings.sensor, support, looks)]
    if len(should) < _UNSEEN_AT_LEAST:
        return False
    back = np.sort(pairs.time[support.agree & ~pairs.seen_by_own])
    saw = np.searchsorted(back, should + 1.5) > np.searchsorted(back, should - 1.5)
    return bool(saw.mean() < _UNSEEN_SHARE)


def _in_view(sensor: Sensor, support: _Support, looks: _Looks) -> np.ndarray:
    """Whether the own robot was well within the other's field of view."""
    own = (looks.own - support.shift) * support.turn.conjugate()
    seen = (own - looks.told) * np.exp(-1j * looks.yaw)
    near, far = max(sensor.nearest, 0.3) + 0.3, min(sensor.farthest, 5.0) - 0.4
    inside = (np.abs(seen) > near) & (np.abs(seen) < far)
    return looks.own_known & inside & (np.abs(np.angle(seen)) < 0.5 * sensor.view - _VIEW_MARGIN)


def _distinct(found: List[_Support], pairs: Pairs) -> List[_Support]:
    """The best supported of those that are about the same, at most _MOST_CHECKED."""
    kept: List[_Support] = []
    for each in sorted(found, key=lambda each: (-each.sightings, each.error)):
        if len(kept) < _MOST_CHECKED and all(_different(each, other, pairs) for other in kept):
            kept.append(each)
    return kept


def _different(first: _Support, second: _Support, pairs: Pairs) -> bool:
    middle = pairs.source[first.agree].mean()
    distance = abs(first.turn * middle + first.shift - second.turn * middle - second.shift)
    return distance > _SAME_M or abs(float(np.angle(first.turn * second.turn.conjugate()))) > _SAME_TURN


def _weighed(sightings: Sightings, pairs: Pairs, support: _Support) -> Hypothesis:
    agree = support.agree
    source = pairs.source[agree]
    ways = _ways(sightings, pairs, support)
    mutual = bool((agree & pairs.seen_by_own).any() and (agree & ~pairs.seen_by_own).any())
    seconds = float(np.ptp(pairs.time[agree]))
    share = _share(pairs, agree)
    both = _seen_by_both(sightings, pairs, support)
    doubts = _doubts_of_motion(sightings.robot, ways, both, support) or _doubts_of_fit(
        sightings.robot, share, seconds, support
    )
    middle = complex(source.mean())
    transform = transform_from(support.turn, support.shift)
    return Hypothesis(
        sightings.own_map.compose(transform).compose(sightings.told_map.inverse()),
        _covariance(source, sightings.jump),
        sightings.told_map.apply_point(middle.real, middle.imag),
        int(support.sightings),
        support.error,
        seconds,
        max((way.length for way in ways), default=0.0),
        _bend(ways),
        mutual,
        share,
        doubts,
    )


def _covariance(source: np.ndarray, jump: float) -> np.ndarray:
    """Of the sightings, and of where a map is of which a part has jumped: its walls have to tell."""
    covariance = covariance_of(source, _DEVIATION_M)
    if jump > 0.0:
        covariance += np.diag([(_JUMP_SHARE * jump) ** 2, (_JUMP_SHARE * jump) ** 2, _JUMP_RAD**2])
    return covariance


def _share(pairs: Pairs, agree: np.ndarray) -> float:
    """Of what was seen of the objects that agree at some time, the part that agrees."""
    per_object = np.bincount(pairs.label[agree], pairs.sightings[agree], pairs.fragments)
    objects = per_object >= _FEWEST_AGREEING
    seen = np.bincount(pairs.label, pairs.sightings, pairs.fragments)
    return float(per_object[objects].sum() / max(seen[objects].sum(), 1.0))


class _Way(NamedTuple):
    """What one robot saw of the other's way. length, width: m. alike: a further robot that moved alike, or ''."""

    length: float
    width: float
    alike: str


def _ways(sightings: Sightings, pairs: Pairs, support: _Support) -> List[_Way]:
    """Without the last moments: what has just begun to differ still agrees."""
    result = []
    proven = support.agree & (pairs.time <= _proven_until(sightings, pairs.time[support.agree].max()))
    for mine in (True, False):
        chosen = proven & (pairs.seen_by_own == mine)
        if chosen.sum() < 3:
            continue
        told, seen = (pairs.source, pairs.target) if mine else (pairs.target, pairs.source)
        alike = _alike(sightings, support, mine, pairs.time[chosen], seen[chosen])
        result.append(_Way(*_extent(told[chosen]), alike))
    return result


def _proven_until(sightings: Sightings, last: float) -> float:
    now = float(sightings.own[-1, 0]) if len(sightings.own) else last
    return max(last - PROBATION_S, now - OUT_OF_SIGHT_S)


def _extent(way: np.ndarray) -> Tuple[float, float]:
    """Length and width, in m, of places (complex (n,))."""
    plane = np.column_stack([way.real, way.imag])
    plane -= plane.mean(axis=0)
    _, axes = np.linalg.eigh(plane.T @ plane)
    width, length = np.ptp(plane @ axes, axis=0).tolist()
    return length, width


def _bend(ways: List[_Way]) -> float:
    """m by which the ways, of those that no further robot can have driven, differ from straight lines."""
    return math.hypot(*(way.width for way in ways if not way.alike))


def _seen_by_both(sightings: Sightings, pairs: Pairs, support: _Support) -> bool:
    """True if each saw the other where the transform says, not in the last moments only."""
    proven = support.agree & (pairs.time <= _proven_until(sightings, pairs.time[support.agree].max()))
    each = [float(pairs.sightings[proven & (pairs.seen_by_own == mine)].sum()) for mine in (True, False)]
    return min(each) >= FEWEST_OF_EACH


def _doubts_of_motion(robot: str, ways: List[_Way], both: bool, support: _Support) -> str:
    path = max((way.length for way in ways), default=0.0)
    if path < SHORTEST_PATH_M:
        return f"waits to see {robot} move"
    if _bend(ways) >= max(SHORTEST_BEND_M, BEND_PER_ERROR * support.error):
        return ""
    alike = " and ".join(sorted({way.alike for way in ways if way.alike}))
    if alike:
        return f"{robot} and {alike} move alike"
    if both:
        # A straight drive gives the heading, whoever it is; then the other sees this robot where that says.
        return ""
    return f"waits to see {robot} turn: a straight drive of {path:.1f} m is like others"


def _doubts_of_fit(robot: str, share: float, seconds: float, support: _Support) -> str:
    if support.error > LARGEST_ERROR_M:
        return f"what moves is {support.error:.2f} m off what {robot} tells"
    if share < SMALLEST_SHARE:
        return f"only {100.0 * share:.0f} % of what moves is where {robot} tells"
    if seconds < SHORTEST_SECONDS or support.sightings < FEWEST_SIGHTINGS:
        return f"has seen {robot} {support.sightings:.0f} times in {seconds:.1f} s only"
    if support.unseen:
        return f"{robot} does not see this robot, though nothing hides it"
    return ""


def _alike(sightings: Sightings, support: _Support, mine: bool, times: np.ndarray, seen: np.ndarray) -> str:
    """A further robot that may have been seen as what was seen, or ''. mine: it was the own robot that saw."""
    to_own = transform_from(support.turn, support.shift)
    to_viewer = Transform() if mine else to_own.inverse()
    placed = {
        name: (sightings.others[name], to_viewer.compose(transform))
        for name, transform in sightings.placed.items()
        if name in sightings.others
    }
    unplaced = {name: track for name, track in sightings.others.items() if name not in placed}
    sweeps = sightings.sweeps if mine else NO_SWEEPS
    return who_was_there(placed, times, seen) or who_moves_alike(unplaced, times, seen, support.error, sweeps)
