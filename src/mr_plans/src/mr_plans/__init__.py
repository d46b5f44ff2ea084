"""Floor plans drawn from a seed: worlds to drive in (`world_plan`), buildings whose maps are registered (`generated`).

Everything is drawn from the generator that is passed in or made from the seed; nothing here knows robots or ROS.
"""

from .kinds import KINDS, generated
from .names import WorldName, is_generated, parse_name
from .plan import FloorPlan, Motion, plan_from_image
from .rooms import bare_rooms_plan, long_corridor_plan, office_plan, symmetric_plan, turned_copies_plan
from .starts import anywhere, side_by_side
from .world_files import WorldFiles, picture_of, robot_starts, world_files
from .worlds import WORLD_KINDS, WorldKind, world_plan

__all__ = [
    "KINDS",
    "WORLD_KINDS",
    "FloorPlan",
    "Motion",
    "WorldFiles",
    "WorldKind",
    "WorldName",
    "anywhere",
    "bare_rooms_plan",
    "generated",
    "is_generated",
    "long_corridor_plan",
    "office_plan",
    "parse_name",
    "picture_of",
    "plan_from_image",
    "robot_starts",
    "side_by_side",
    "symmetric_plan",
    "turned_copies_plan",
    "world_files",
    "world_plan",
]
