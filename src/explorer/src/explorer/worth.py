"""What is worth a visit: which frontier points are goals."""

from typing import Dict, FrozenSet, Mapping, NamedTuple, Sequence, Tuple

import numpy as np

from explorer._kernels import nearest_near
from explorer.clusters import Cluster
from explorer.frontiers import Frontier, points_of
from explorer.grid import OccupancyMap
from explorer.heard import Heard, KnownArea
from explorer.prospects import Prospect
from explorer.verdicts import Verdicts

TOLD_DISTANCE = 0.5  # m, own frontiers this near to an explored point of another robot are no goals


# Tuned on the office floor (seeds 61 to 67, 603 to 607), on `narrow` (61, 62), generated:office:71:30x20 (61) and
# generated:hall:612 (621).
LEAST_AREA = 0.25  # m^2 that must be unknown behind a point
LEAST_POINTS = 2  # of that kind that make a cluster a goal; one less where the robot can pass
ROOM = 0.8  # m^2 of unknown ground where the robot might stand, behind two points, make an opening
WAY_FOR_AREA = 4.0  # m of way that a square metre is worth that is no opening
LEFT_SHARE = 0.005  # of the known free area: m^2 of unknown ground that may be left unseen in small pieces

VISITED, GIVEN_UP = "visited", "given up"
TOLD = "told by {}"
NOISE = "noise"
FEW_POINTS = "too short"
NOT_WORTH_THE_WAY = "not worth the way"
LITTLE = frozenset((NOISE, FEW_POINTS, NOT_WORTH_THE_WAY))


class Worth(NamedTuple):
    """`goals`: {number: frontier} of the points that are worth a visit now. `reasons`: {number: reason} why the others
    are not, in words for people. `told`: robots without whose word, that they have explored them, more would be."""

    goals: Dict[int, Frontier]
    reasons: Dict[int, str]
    told: FrozenSet[str]


def worth_of(
    clusters: Sequence[Cluster],
    prospects: Mapping[int, Prospect],
    verdicts: Verdicts,
    known: KnownArea,
    now: float,
) -> Worth:
    """Which members of the clusters are goals, by what is unknown behind them and what was decided about them."""
    reasons: Dict[int, str] = {}
    for cluster in clusters:
        reasons.update(_little_behind(cluster, prospects))
        reasons.update(_decided(cluster, verdicts))
    goals = [member for cluster in clusters for member in cluster.members if member.number not in reasons]
    points = points_of(goals)
    decided = verdicts.heard.decided(points, known)
    explored = _explored(points, *verdicts.told_places(now))
    told = {goals[row].number: TOLD.format(robot) for row, robot in {**explored, **decided}.items()}
    by = frozenset(robot for row, robot in explored.items() if row not in decided)
    return Worth({f.number: f for f in goals if f.number not in told}, {**reasons, **told}, by)


def _explored(points: np.ndarray, places: np.ndarray, robots: Sequence[str]) -> Dict[int, str]:
    """{row: robot} of those of the points that are near a place which a robot has explored; (n, 2) arrays in metres."""
    nearest = nearest_near(points, places, TOLD_DISTANCE).tolist()
    return {row: robots[place] for row, place in enumerate(nearest) if place >= 0}


def without_denied(
    clusters: Sequence[Cluster],
    worth: Worth,
    prospects: Mapping[int, Prospect],
    heard: Heard,
    occupancy: OccupancyMap,
) -> Tuple[Tuple[Cluster, ...], Worth]:
    """The clusters without views where they are no openings and a robot that has nothing left does not know of them:
    they are there on the own map, `occupancy`, alone."""
    reasons: Dict[int, str] = {}
    for cluster in clusters if heard.witnesses else ():
        if is_opening([prospects[number] for number in cluster.views]):
            continue
        robot = heard.denied_by(cluster.points, occupancy.known_area) if cluster.views else None
        if robot is not None:
            reasons.update(dict.fromkeys(cluster.views, TOLD.format(robot)))
    return _without(clusters, worth, reasons)


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
    reasons: Dict[int, str] = {}
    for cluster in clusters:
        if cluster.views and _is_detour(cluster, [prospects[number] for number in cluster.views]):
            reasons.update(dict.fromkeys(cluster.views, NOT_WORTH_THE_WAY))
    return _without(clusters, worth, reasons)


def _without(
    clusters: Sequence[Cluster], worth: Worth, reasons: Mapping[int, str]
) -> Tuple[Tuple[Cluster, ...], Worth]:
    """The clusters without views where these are no goals any more, for the reasons by number."""
    result = tuple(
        cluster.unseen(cluster.gain) if not reasons.keys().isdisjoint(cluster.views) else cluster
        for cluster in clusters
    )
    goals = {number: frontier for number, frontier in worth.goals.items() if number not in reasons}
    return result, worth._replace(goals=goals, reasons={**worth.reasons, **reasons})


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
    return not is_opening(seen) and cluster.cost > WAY_FOR_AREA * max(prospect.area for prospect in seen)


def is_opening(seen: Sequence[Prospect]) -> bool:
    """True if there is ground where the robot might stand behind points with these prospects."""
    rooms = [prospect.enterable for prospect in seen if prospect.enterable >= ROOM]
    return len(rooms) >= 2 or sum(rooms) >= 2 * ROOM
