"""What of a mission outlives the node: kept outside of it, and handed in again when it is started anew."""

import json
import math
from dataclasses import asdict, dataclass
from typing import Any, Optional

from explorer.errors import ExplorerError
from mr_grid import Pose, is_place


class MemoryTextError(ExplorerError):
    """A text that no mission was kept in."""


@dataclass(frozen=True)
class Memory:
    """Times in s, None while it has not come to that; `distance` in whole m; `halt`: the order that holds the robot
    (`orders.PAUSED`, `orders.CALLED`), or empty; `ended_by` as in `Orders`, empty while it explores; `home_is_lost` as
    in `Senses`."""

    home: Optional[Pose] = None
    started_at: Optional[float] = None
    finished_at: Optional[float] = None
    ended_by: str = ""
    homeward: bool = True
    halt: str = ""
    distance: float = 0.0
    home_is_lost: bool = False

    def text(self) -> str:
        return json.dumps(asdict(self))


def memory_of(text: str) -> Memory:
    """The memory that became `text`. Raises MemoryTextError."""
    try:
        given = json.loads(text)
        home = given.pop("home")
        memory = Memory(home=None if home is None else Pose(*home), **given)
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise MemoryTextError(f"parameter ~memory cannot be read, the mission starts anew: {error}") from error
    numbers = [memory.distance, *(memory.home or ())]
    times = [time for time in (memory.started_at, memory.finished_at) if time is not None]
    if not all(_is_number(value) for value in [*numbers, *times]) or not all(map(is_place, memory.home or ())):
        raise MemoryTextError("parameter ~memory holds what is no number, the mission starts anew")
    return memory


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and math.isfinite(value)
