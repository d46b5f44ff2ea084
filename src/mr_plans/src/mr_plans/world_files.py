"""A plan as Stage's files: a picture and a world file with sixteen robots."""

import math
from typing import List, NamedTuple, Tuple

import numpy as np

from .names import ROBOTS, WorldName
from .plan import FloorPlan
from .starts import Start, anywhere, side_by_side
from .worlds import WORLD_KINDS, world_plan

COLOURS = ("red", "blue", "green", "orange", "purple", "cyan", "magenta", "brown", "yellow", "gray")

_WORLD = """# {name}: {what}.
# World frame: origin in the lower left corner, x right, y up. Drawn by mr_plans.

{includes}

# That of the picture: a pixel is a cell.
resolution {resolution:g}
interval_sim 50

floorplan
(
  name "{stem}"
  bitmap "{stem}.png"
  size [ {length:g} {depth:g} 0.8 ]
  pose [ {middle_x:g} {middle_y:g} 0.0 0.0 ]
)

{robots}
"""


class WorldFiles(NamedTuple):
    """`picture`: PNG, black walls; `text`: of the world file, which includes MODEL.inc of each of the `models` from its
    own folder."""

    stem: str
    picture: bytes
    text: str
    models: Tuple[str, ...] = ("pioneer",)


def world_files(name: WorldName, radius: float) -> WorldFiles:
    """The same for the same name. `radius`: m, of the largest robot, from its middle to its farthest corner.
    ValueError if the world holds no sixteen robots."""
    plan = world_plan(name.kind, name.seed, name.size)
    starts = (anywhere if name.anywhere else side_by_side)(plan, name.seed, radius)
    return WorldFiles(name.stem, picture_of(plan), _text(name, plan, starts), _models(name))


def picture_of(plan: FloorPlan) -> bytes:
    """A PNG of one pixel per cell, walls black."""
    import cv2  # here, for who needs no picture: it is slow to import

    done, data = cv2.imencode(".png", np.where(np.flipud(plan.walls), 0, 255).astype(np.uint8))
    if not done:
        raise ValueError("the plan cannot be encoded as a picture")
    return bytes(data)


def _models(name: WorldName) -> Tuple[str, ...]:
    """Whose files the world includes; that of the Pioneer also says what a floor plan is."""
    return tuple(dict.fromkeys(("pioneer", *ROBOTS[name.robots])))


def _text(name: WorldName, plan: FloorPlan, starts: List[Start]) -> str:
    rows, columns = plan.walls.shape
    length, depth = columns * plan.resolution, rows * plan.resolution
    models = ROBOTS[name.robots]
    robots = "\n".join(
        f'{models[number % len(models)]} ( name "robot_{number}" pose [ {x:g} {y:g} 0 {math.degrees(heading):.0f} ] '
        f'color "{COLOURS[number % len(COLOURS)]}" )'
        for number, (x, y, heading) in enumerate(starts)
    )
    return _WORLD.format(
        name=name.stem, stem=name.stem, what=WORLD_KINDS[name.kind].what, resolution=plan.resolution, length=length,
        depth=depth, middle_x=0.5 * length, middle_y=0.5 * depth, robots=robots,
        includes="\n".join(f'include "{model}.inc"' for model in _models(name)),
    )  # fmt: skip
