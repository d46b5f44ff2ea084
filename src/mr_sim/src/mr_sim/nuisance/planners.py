"""Another planner in the place of the hybrid A* that plans manoeuvres, for comparison."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from mr_robot import _navigation

Planner = Callable[..., np.ndarray]
"""Takes and returns what `mr_robot._navigation.manoeuvre` does."""

OURS: Planner = _navigation.manoeuvre
PLACE = "manoeuvre"


@contextmanager
def planning_with(planner: Planner) -> Iterator[list[float]]:
    """Lets all navigation of this process plan manoeuvres so; gives the processor time of each plan, s."""
    spent: list[float] = []

    def timed(*arguments: object) -> np.ndarray:
        begun = time.process_time()
        way = planner(*arguments)
        spent.append(time.process_time() - begun)
        return way

    setattr(_navigation, PLACE, timed)
    try:
        yield spent
    finally:
        setattr(_navigation, PLACE, OURS)


def ompl(radius: float, limit: float) -> Planner:
    """RRT-Connect of OMPL. `radius`: m of Reeds and Shepp's ways. `limit`: s of processor time of a plan."""
    import _ompl_peer as core

    def plan(*arguments: object) -> np.ndarray:
        cost, _, *situation, _, _ = arguments  # not the map, how far obstacles are known, how near it may come
        return core.manoeuvre(cost, *situation, radius, limit)

    return plan
