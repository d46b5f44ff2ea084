"""Whether edges have changed so much that it matters."""

import math
from typing import NamedTuple, Sequence

from ..transform import rotation_between
from .edges import Edge


class Change(NamedTuple):
    """What may change without mattering. covariance: factor of a variance; infinite: the covariance does not matter."""

    distance_m: float
    rotation_rad: float
    weight: float
    covariance: float


def differ(before: Sequence[Edge], after: Sequence[Edge], least: Change) -> bool:
    """True if there are edges to other robots or runs, or one has changed by more than `least`."""
    known = {(edge.target, edge.target_run): edge for edge in before}
    present = {(edge.target, edge.target_run): edge for edge in after}
    return known.keys() != present.keys() or not all(_alike(known[key], present[key], least) for key in present)


def _alike(first: Edge, second: Edge, least: Change) -> bool:
    """False also where a value is no number."""
    if first is second:
        return True
    return (
        first.reporter == second.reporter
        and first.reporter_run == second.reporter_run
        and math.hypot(first.transform.x - second.transform.x, first.transform.y - second.transform.y)
        <= least.distance_m
        and rotation_between(first.transform, second.transform) <= least.rotation_rad
        and abs(first.weight - second.weight) <= least.weight
        and (math.isinf(least.covariance) or _alike_spread(first, second, least.covariance))
    )


def _alike_spread(first: Edge, second: Edge, factor: float) -> bool:
    """True if each variance is within the factor of the other one's."""
    return all(
        one[i] <= factor * other[i] and other[i] <= factor * one[i]
        for i, (one, other) in enumerate(zip(first.covariance, second.covariance))
    )
