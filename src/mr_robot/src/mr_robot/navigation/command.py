"""What the navigation engine says in each period."""

from dataclasses import dataclass
from enum import Enum
from typing import Tuple

Velocity = Tuple[float, float]
"""m/s ahead, rad/s to the left."""


class Status(Enum):
    IDLE = "idle"
    ACTIVE = "active"
    SUCCEEDED = "succeeded"
    ABORTED = "aborted"


@dataclass(frozen=True)
class Command:
    linear: float  # m/s
    angular: float  # rad/s
    status: Status
    text: str = ""  # why, when ABORTED


class GivenUp(Exception):
    """A goal that cannot be reached; the text says why."""
