"""What is left unexplored and why, to be told to people."""

from collections import Counter
from typing import Dict, Mapping, NamedTuple, Sequence, Tuple

from explorer.clusters import Cluster
from explorer.prospects import Prospect
from explorer.worth import Worth

MAXIMUM_TOLD = 8  # places that are named, the largest first
UNSEEN = "no place to look from"
WAITING = "not tried yet"


class Left(NamedTuple):
    """Frontier points near (x, y), metres in the own map frame, that show `area` m^2 of unknown at most."""

    x: float
    y: float
    points: int
    area: float
    reason: str


def leftovers(clusters: Sequence[Cluster], worth: Worth, prospects: Mapping[int, Prospect]) -> Tuple[Left, ...]:
    """One for each cluster, the largest first; the reason is that of most of its points."""
    left = []
    for cluster in clusters:
        area = max(prospects[number].area for number in cluster.numbers)
        left.append(Left(*cluster.centre, len(cluster.members), area, _reason(cluster, worth)))
    return tuple(sorted(left, key=lambda entry: (-entry.area, entry.x, entry.y)))


def _reason(cluster: Cluster, worth: Worth) -> str:
    otherwise = WAITING if cluster.reachable else UNSEEN
    reasons = Counter(worth.reasons.get(number, otherwise) for number in sorted(cluster.numbers))
    return reasons.most_common(1)[0][0]


def reasons(clusters: Sequence[Cluster], worth: Worth) -> Dict[int, str]:
    """{number: reason} of the points that are not looked at from anywhere now."""
    missing = {number: cluster for cluster in clusters for number in cluster.numbers if number not in cluster.views}
    return {number: worth.reasons.get(number, UNSEEN) for number in sorted(missing)}


def sentence(left: Sequence[Left]) -> str:
    """For people: how much is left, where the largest pieces are, and why."""
    if not left:
        return "nothing is left unexplored"
    places = [f"({e.x:.1f}, {e.y:.1f}) {e.area:.1f} m² {e.reason}" for e in left[:MAXIMUM_TOLD]]
    more = f" and {len(left) - MAXIMUM_TOLD} smaller ones" if len(left) > MAXIMUM_TOLD else ""
    return f"left unexplored at {len(left)} places: {'; '.join(places)}{more}"
