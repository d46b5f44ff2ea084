"""Pairs of partial maps with known transform, from generated floor plans: what registration is measured on.

Everything is drawn from the generator that is passed in, so a seed repeats a pair.
"""

from mr_plans import (
    KINDS,
    FloorPlan,
    bare_rooms_plan,
    generated,
    long_corridor_plan,
    office_plan,
    plan_from_image,
    symmetric_plan,
    turned_copies_plan,
)

from .rearranging import rearranged
from .scanning import GridDrawer, Survey, cast, info_around
from .surveyor import Pair, RobotMap, Surveyor, pair_of

__all__ = [
    "KINDS",
    "FloorPlan",
    "GridDrawer",
    "Pair",
    "RobotMap",
    "Survey",
    "Surveyor",
    "bare_rooms_plan",
    "cast",
    "generated",
    "info_around",
    "long_corridor_plan",
    "office_plan",
    "pair_of",
    "plan_from_image",
    "rearranged",
    "symmetric_plan",
    "turned_copies_plan",
]
