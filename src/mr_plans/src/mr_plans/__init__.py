"""Floor plans drawn from a seed: worlds to drive in (`world_plan`), buildings whose maps are registered (`generated`).

Everything is drawn from the generator that is passed in or made from the seed; nothing here knows robots or ROS.
"""

from .kinds import KINDS, generated
from .plan import FloorPlan, Motion, plan_from_image
from .rooms import bare_rooms_plan, long_corridor_plan, office_plan, symmetric_plan, turned_copies_plan

__all__ = [
    "KINDS",
    "FloorPlan",
    "Motion",
    "bare_rooms_plan",
    "generated",
    "long_corridor_plan",
    "office_plan",
    "plan_from_image",
    "symmetric_plan",
    "turned_copies_plan",
]
