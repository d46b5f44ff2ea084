"""A plan as Stage's files: a picture and a world file with its robots."""

import math
from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from .names import WorldName
from .plan import FloorPlan
from .starts import MOST_ROBOTS, Start, anywhere, side_by_side
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
    """`picture`: PNG, black walls; `text`: of the world file, which includes NAME.inc of each of the `models` from its
    own folder."""

    stem: str
    picture: bytes
    text: str
    models: Tuple[str, ...] = ("pioneer",)


def world_files(name: WorldName, radius: float, edition: str = "") -> WorldFiles:
    """The same for the same arguments. `radius`: m, of the largest robot, from its middle to its farthest corner.
    `edition`: tells files of one name apart that define different robots. Sixteen robots, or of a robot file's as many
    as there is room for. ValueError if there is none."""
    plan = world_plan(name.kind, name.seed, name.size)
    stem = f"{name.stem}-{edition}" if edition else name.stem
    included = tuple(dict.fromkeys(("pioneer", *(f"{model}-{edition}" if edition else model for model in name.models))))
    starts = robot_starts(name, plan, radius)
    return WorldFiles(stem, picture_of(plan), _text(name, plan, starts, stem, included), included)


def robot_starts(name: WorldName, plan: FloorPlan, radius: float) -> List[Start]:
    """Of its robots in the world's plan. Arguments and ValueError as of `world_files`."""
    place = anywhere if name.anywhere else side_by_side
    fewest = MOST_ROBOTS if name.robot_file is None else 1
    for count in range(MOST_ROBOTS, fewest, -1):
        try:
            return place(plan, name.seed, radius, count)
        except ValueError:
            continue
    return place(plan, name.seed, radius, fewest)


def picture_of(plan: FloorPlan) -> bytes:
    """A PNG of one pixel per cell, walls black."""
    import cv2  # here, for who needs no picture: it is slow to import

    done, data = cv2.imencode(".png", np.where(np.flipud(plan.walls), 0, 255).astype(np.uint8))
    if not done:
        raise ValueError("the plan cannot be encoded as a picture")
    return bytes(data)


def _text(name: WorldName, plan: FloorPlan, starts: List[Start], stem: str, included: Sequence[str]) -> str:
    """`included`: names of files; that of the Pioneer also says what a floor plan is."""
    rows, columns = plan.walls.shape
    length, depth = columns * plan.resolution, rows * plan.resolution
    models = name.models
    robots = "\n".join(
        f'{models[number % len(models)]} ( name "robot_{number}" pose [ {x:g} {y:g} 0 {math.degrees(heading):.0f} ] '
        f'color "{COLOURS[number % len(COLOURS)]}" )'
        for number, (x, y, heading) in enumerate(starts)
    )
    return _WORLD.format(
        name=stem, stem=stem, what=WORLD_KINDS[name.kind].what, resolution=plan.resolution, length=length,
        depth=depth, middle_x=0.5 * length, middle_y=0.5 * depth, robots=robots,
        includes="\n".join(f'include "{file}.inc"' for file in included),
    )  # fmt: skip
