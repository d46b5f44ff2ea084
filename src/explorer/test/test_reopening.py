"""What brings a robot back that has ended: openings that are new, not those that it has left."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from explorer.clusters import Cluster
from explorer.frontiers import Frontier
from explorer.leftovers import Left
from explorer.perception import Perception
from explorer.reopening import Reopening
from explorer.scene import Scene

DELAY = 3.0


class Map:
    """One place that was left; `known` m^2 around any place."""

    def __init__(self) -> None:
        self.known = 2.0

    def leftovers(self) -> Any:
        return (Left(5.0, 5.0, 3, 4.7, "told by robot_3"),)

    def known_area_near(self, x: float, y: float) -> float:
        return self.known

    def is_opening(self, cluster: Cluster) -> bool:
        return True


def wanted(reopening: Reopening, x: float) -> bool:
    cluster = Cluster(1, tuple(Frontier(n, x + 0.2 * n, 5.0) for n in range(3)))
    scenes = [SimpleNamespace(now=now, open=[cluster], claimed={}) for now in (100.0, 100.0 + DELAY)]
    return [reopening.wanted(cast(Scene, scene)) for scene in scenes][-1]


@pytest.mark.parametrize(
    "x, more, expected", [(5.5, 0.0, False), (5.5, 0.4, False), (5.5, 0.6, True), (8.0, 0.0, True)]
)
def test_a_leftover_opens_nothing_before_the_map_shows_much_more_there(x: float, more: float, expected: bool) -> None:
    """The way home passed a place that a mate had explored in vain: a few more cells known there, and the robot went on
    for a minute."""
    seen = Map()
    reopening = Reopening(DELAY, cast(Perception, seen))
    reopening.end()
    seen.known += more
    assert wanted(reopening, x) == expected
