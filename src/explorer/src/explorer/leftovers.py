"""Why frontier points are no goals, in words."""

from typing import Dict

from explorer.perception import Perception
from explorer.verdicts import Verdicts

VISITED = "visited"
GIVEN_UP = "given up"
TOLD = "told explored by another robot"
NO_VIEW = "no reachable place to look from"


def reasons(perception: Perception, verdicts: Verdicts) -> Dict[int, str]:
    """{number: reason} of those points on the map that are no goals."""
    seen = {number for cluster in perception.clusters for number in cluster.views}
    missing = sorted(set(perception.frontiers.frontiers) - seen)
    return {number: _reason(number, perception, verdicts) for number in missing}


def _reason(number: int, perception: Perception, verdicts: Verdicts) -> str:
    verdict = verdicts.of(number)
    if verdict.visited:
        return VISITED
    if verdict.given_up:
        return GIVEN_UP
    return NO_VIEW if number in perception.worth.goals else TOLD
