"""What is worth a visit: which frontier points are goals."""

import math
from dataclasses import replace
from typing import Dict, Mapping, NamedTuple, Sequence, Tuple

import numpy as np

from explorer._kernels import near_any
from explorer.clusters import Cluster
from explorer.frontiers import Frontier
from explorer.prospects import Prospect
from explorer.verdicts import Verdicts

TOLD_DISTANCE = 0.5  # m, own frontiers this near to an explored point of another robot are no goals


# Tuned on the office floor (seeds 61 to 67), on `narrow` (61, 62) and on generated:office:71:30x20 (61).
LEAST_AREA = 0.25  # m^2 that must be unknown behind a point
LEAST_POINTS = 2  # of that kind that make a cluster a goal; one less where the robot can pass
ROOM = 0.5  # m^2 of unknown ground where the robot might stand, behind two points, make an opening
WAY_FOR_AREA = 4.0  # m of way that a square metre is worth that is no opening
LEFT_SHARE = 0.004  # of the known free area: m^2 of unknown ground that may be left unseen in small pieces

VISITED, GIVEN_UP = "visited", "given up"
TOLD = "told by another robot"
NOISE = "noise"
FEW_POINTS = "too short"
NOT_WORTH_THE_WAY = "not worth the way"
LITTLE = frozenset((NOISE, FEW_POINTS, NOT_WORTH_THE_WAY))


class Worth(NamedTuple):
    """`goals`: {number: frontier} of the points that are worth a visit now. `reasons`: {number: reason} why the others
    are not, in words for people. `told`: some are not only because another robot says that it has explored them."""

    goals: Dict[int, Frontier]
    reasons: Dict[int, str]
    told: bool


def worth_of(clusters: Sequence[Cluster], prospects: Mapping[int, Prospect], verdicts: Verdicts, now: float) -> Worth:
    """Which members of the clusters are goals, by what is unknown behind them and what was decided about them."""
    reasons: Dict[int, str] = {}
    for cluster in clusters:
        reasons.update(_little_behind(cluster, prospects))
        reasons.update(_decided(cluster, verdicts))
    goals = [member for cluster in clusters for member in cluster.members if member.number not in reasons]
    points = np.array([(f.x, f.y) for f in goals], dtype=float).reshape(-1, 2)
    told = near_any(points, verdicts.told_places(now), TOLD_DISTANCE)
    reasons.update({f.number: TOLD for f, is_told in zip(goals, told) if is_told})
    return Worth({f.number: f for f in goals if f.number not in reasons}, reasons, bool(told.any()))


def _decided(cluster: Cluster, verdicts: Verdicts) -> Dict[int, str]:
    """{number: reason} of the members on which there is a verdict."""
    decided = [number for number in cluster.numbers if not verdicts.is_goal(number)]
    return {number: VISITED if verdicts.of(number).visited else GIVEN_UP for number in decided}


def _little_behind(cluster: Cluster, prospects: Mapping[int, Prospect]) -> Dict[int, str]:
    """{number: reason} of the members behind which too little is unknown."""
    numbers = [member.number for member in cluster.members]
    noise = [number for number in numbers if prospects[number].area < LEAST_AREA]
    rest = [number for number in numbers if prospects[number].area >= LEAST_AREA]
    reasons = dict.fromkeys(noise, NOISE)
    if len(rest) < LEAST_POINTS - any(prospects[number].passable for number in rest):
        reasons.update(dict.fromkeys(rest, FEW_POINTS))
    return reasons


def without_detours(
    clusters: Sequence[Cluster], worth: Worth, prospects: Mapping[int, Prospect]
) -> Tuple[Tuple[Cluster, ...], Worth]:
    """The clusters without views where they are no openings and not worth the way to them; the points are no goals."""
    reasons, result = dict(worth.reasons), []
    for cluster in clusters:
        if cluster.views and _is_detour(cluster, [prospects[number] for number in cluster.views]):
            reasons.update(dict.fromkeys(cluster.views, NOT_WORTH_THE_WAY))
            cluster = replace(cluster, cost=math.inf, viewpoint=None, target=None, views={})
        result.append(cluster)
    goals = {number: frontier for number, frontier in worth.goals.items() if number not in reasons}
    return tuple(result), worth._replace(goals=goals, reasons=reasons)


def too_much_to_leave(
    clusters: Sequence[Cluster], worth: Worth, prospects: Mapping[int, Prospect], free_area: float
) -> Dict[int, Frontier]:
    """When no goal is left: the points {number: frontier} that were left only because they show little, of the largest
    clusters of these, so that the rest is a small share of `free_area`, m^2 of known free ground."""
    left = []
    for cluster in clusters:
        members = [m for m in cluster.members if worth.reasons.get(m.number) in LITTLE]
        members = [m for m in members if prospects[m.number].enterable > 0.0]
        if members:
            left.append((max(prospects[m.number].enterable for m in members), cluster.number, members))
    rest, taken = sum(area for area, _, _ in left), {}
    for area, _, members in sorted(left, key=lambda entry: (-entry[0], entry[1])):
        if rest <= LEFT_SHARE * free_area:
            break
        rest -= area
        taken.update({member.number: member for member in members})
    return taken


def _is_detour(cluster: Cluster, seen: Sequence[Prospect]) -> bool:
    rooms = [prospect.enterable for prospect in seen if prospect.enterable >= ROOM]
    if len(rooms) >= 2 or sum(rooms) >= 2 * ROOM:
        return False
    return cluster.cost > WAY_FOR_AREA * max(prospect.area for prospect in seen)
