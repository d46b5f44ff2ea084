"""Names of generated worlds: `generated:KIND:SEED[:LENGTHxDEPTH][:anywhere][:turtlebots|:mixed|:ROBOT.inc]`."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Optional, Tuple

from .worlds import WORLD_KINDS, check_world

PREFIX = "generated:"
FORM = "generated:KIND:SEED[:LENGTHxDEPTH][:anywhere][:turtlebots|:mixed|:ROBOT.inc]"
PIONEERS = "pioneers"
ROBOTS = {PIONEERS: ("pioneer",), "turtlebots": ("turtlebot",), "mixed": ("pioneer", "turtlebot")}
"""Models, by turns, of a world's robots."""
ROBOT_FILE = ".inc"
"""Ends the name of a file that defines a model of robots, which has the name of the file."""
_PATTERN = re.compile(
    r"generated:(?P<kind>[^:]*):(?P<seed>\d{1,18})(:(?P<size>[\d.]+x[\d.]+))?(?P<anywhere>:anywhere)?"
    r"(:(?P<robots>turtlebots|mixed|[^:]*[^:/]\.inc))?"
)


@dataclass(frozen=True)
class WorldName:
    """`size`: length and depth in m. `anywhere`: the robots start all over the world, not side by side.
    `robots`: one of `ROBOTS`, or the path of a robot's file."""

    kind: str
    seed: int
    size: Tuple[float, float]
    anywhere: bool = False
    robots: str = PIONEERS

    @property
    def robot_file(self) -> Optional[Path]:
        """That defines the model of its robots, where it is none of ours."""
        return Path(self.robots) if self.robots.endswith(ROBOT_FILE) else None

    @property
    def models(self) -> Tuple[str, ...]:
        """Of its robots, by turns."""
        return ROBOTS[self.robots] if self.robot_file is None else (self.robot_file.stem,)

    @property
    def stem(self) -> str:
        """Names the world's files; tells apart whatever differs."""
        length, depth = self.size
        plan = f"generated-{self.kind}-{self.seed}-{length:g}x{depth:g}"
        robots = "" if self.robots == PIONEERS else f"-{self.robots if self.robot_file is None else self.models[0]}"
        return plan + ("-anywhere" if self.anywhere else "") + robots


def is_generated(name: str) -> bool:
    """Whether this asks for a generated world, rightly or wrongly."""
    return name.startswith(PREFIX)


def parse_name(name: str) -> WorldName:
    """Raises ValueError that says what is wrong in it."""
    found = _PATTERN.fullmatch(name)
    if found is None:
        raise ValueError(f"{name!r} does not have the form {FORM}, as generated:office:7 or generated:hall:3:40x25")
    kind, seed, text = found["kind"], int(found["seed"]), found["size"]
    try:
        size = tuple(float(side) for side in text.split("x")) if text else WORLD_KINDS[kind].size
    except KeyError:
        size = (0.0, 0.0)
    except ValueError:
        raise ValueError(f"{name!r} has a size that is no LENGTHxDEPTH in m: {text!r}") from None
    check_world(kind, seed, (size[0], size[1]))
    return WorldName(kind, seed, (size[0], size[1]), found["anywhere"] is not None, found["robots"] or PIONEERS)
