"""What a robot tells people and programs about the state of its merging."""

from dataclasses import dataclass
from typing import Optional, Tuple

from mr_grid import Pose

NEVER = -1.0
"""Age of a robot of which nothing was heard yet."""
Rows = Tuple[Tuple[float, float, float], Tuple[float, float, float], Tuple[float, float, float]]
NO_COVARIANCE: Rows = ((0.0, 0.0, 0.0),) * 3


@dataclass(frozen=True)
class RobotPlacement:
    """One other robot. transform: its map frame -> the own one, None unless believed; covariance of its (x, y, yaw);
    via: robot through which it is placed, empty if by own evidence; shared wall in m; age in s since its last news."""

    robot: str
    why: str
    transform: Optional[Pose] = None
    via: str = ""
    covariance: Rows = NO_COVARIANCE
    confidence: float = 0.0
    shared_wall: float = 0.0
    age: float = NEVER
    bytes_received: int = 0

    def __post_init__(self) -> None:
        if not 0.0 <= self.confidence <= 1.0:
            raise ValueError(f"a confidence is from 0 to 1, not {self.confidence:g}")

    @property
    def placed(self) -> bool:
        """True if the transform is believed."""
        return self.transform is not None


@dataclass(frozen=True)
class MergerStatus:
    """State of the merging on robot `robot`; the others in any order."""

    robot: str
    topology: str
    base_station: str
    robots: Tuple[RobotPlacement, ...]
    wants_to_meet: Tuple[str, ...] = ()
    """Robots that have been in hearing for long without being placed: a request to those who choose goals."""
    awaited: str = ""
    """The map without which nothing is merged, in words; empty when it is there."""


def summary_of(status: MergerStatus) -> str:
    """One line for people: what it waits for, or how many robots are placed, and why the others are not."""
    if status.awaited:
        return f"waits for {status.awaited}"
    heard = {each.robot for each in status.robots}
    if status.topology == "centralized" and status.base_station not in heard | {status.robot}:
        return f"waits for the base station {status.base_station}, which was not heard of"
    if not heard:
        return "no other robot was heard of"
    missing = [f"{each.robot}: {each.why}" for each in status.robots if not each.placed]
    placed = len(status.robots) - len(missing)
    return "; ".join([f"{placed} of {len(status.robots)} robots placed", *missing])
