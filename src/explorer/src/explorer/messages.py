"""What goes in and out of the agent, as plain values. `ros_io` converts them from and to ROS messages."""

from dataclasses import dataclass
from typing import Callable, Tuple, Union

from explorer.foreign import Element, Key
from explorer.limits import Limits
from explorer.statement import Statement
from explorer.team_state import TeamState
from mr_grid import Pose

PAPER_UNIT = 1
"""Bids are squared distances in m^2, as those of strategy 1 and of robots that tell no unit (contract 3.7)."""


@dataclass(frozen=True)
class Bid:
    """A cluster as the list of its elements, and what a robot bids for it; negative: no bid."""

    elements: Tuple[Key, ...]
    bid: float = -1.0


@dataclass(frozen=True)
class Auction:
    """`adhoc_communication/ExpAuction` (contract 3.7). `status` tells the auctioneer's messages (start, closing) from
    the bids of the others; `robot` is the sender. `unit`: what bids are counted in."""

    robot: str
    auction_id: int
    status: bool
    start: bool = False
    finished: bool = False
    occupied: Tuple[Key, ...] = ()
    requested: Tuple[Bid, ...] = ()
    available: Tuple[Bid, ...] = ()
    unit: int = PAPER_UNIT


@dataclass(frozen=True)
class SendFrontiers:
    """To the own group on `topic`: frontiers, visited_frontiers or negotiation_list."""

    topic: str
    elements: Tuple[Element, ...]


@dataclass(frozen=True)
class SendAuction:
    """To the own group on topic auction."""

    auction: Auction


@dataclass(frozen=True)
class SendStatement:
    """To the own group as a message of its own type."""

    statement: Statement


@dataclass(frozen=True)
class SetGoal:
    """Drive to `pose`, replacing the goal before. The outcome comes back under `goal_id`."""

    goal_id: int
    pose: Pose


@dataclass(frozen=True)
class CancelGoal:
    """Stop; the goal is no longer wanted."""

    goal_id: int


@dataclass(frozen=True)
class AskTransform:
    """Ask map_merger for the transform from a robot's map frame to the own one; the answer is `on_transform`."""

    robot: str


@dataclass(frozen=True)
class LogOutput:
    """Call map_merger's log service with a bit mask; no answer is awaited."""

    mask: int


@dataclass(frozen=True)
class WriteLog:
    """Write a text file in the robot's log folder."""

    name: str
    text: str
    append: bool = False


@dataclass(frozen=True)
class Note:
    """One line for people; `warning` if something is not as it should be."""

    text: str
    warning: bool = False


@dataclass(frozen=True)
class SendState:
    """Tell the mission control on robot `to` how this robot is: a `team_orders.TeamState`."""

    to: str
    state: TeamState


@dataclass(frozen=True)
class KeepLimits:
    """Somebody has set them: they hold when the node is started again, too."""

    limits: Limits


Effect = Union[
    SendFrontiers, SendAuction, SendStatement, SendState, SetGoal, CancelGoal, AskTransform, LogOutput, WriteLog,
    KeepLimits, Note,
]  # fmt: skip

Emit = Callable[[Effect], None]
"""Takes an effect; they are carried out in the order given."""

# Outcomes of a goal for `on_goal_result`.
REACHED = "reached"
FAILED = "failed"
REPLACED = "replaced"
