"""What the agent wants done. The host carries these out and reports back where stated."""

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple, Optional, Tuple, Union

import numpy as np

from mr_grid import OccupancyGrid, Pose

from .grid import Box
from .job import Job
from .messages import Boot, Tile
from .payload import Payload
from .whereabouts import Place

GROUP_PREFIX = "mc_"
"""Group names of adhoc_communication begin with it."""


class Purpose(Enum):
    """Why something is sent. What has different purposes does not wait for one another: each is a lane of its own."""

    CHANGES = "changes"
    ANSWER = "answer"
    REQUEST = "request"
    POSITION = "position"
    ANCHOR = "anchor"
    TRACK = "track"
    EDGES = "edges"


@dataclass(frozen=True, eq=False)
class Send:
    """Send the payloads in order to a robot or group. Report the `Outcome` with `Agent.on_sent`.

    To a robot: stop at the first that fails; it and the rest were not delivered. To a group, whose members have
    different luck: each payload stands by itself, so go on with the next.
    """

    number: int
    purpose: Purpose
    destination: str
    payloads: Tuple[Payload, ...]

    @property
    def to_group(self) -> bool:
        """True if the destination is a group of robots."""
        return self.destination.startswith(GROUP_PREFIX)


class Outcome(NamedTuple):
    """What became of a Send. undelivered: those of its payloads that somebody missed. too_large: the first tile that
    the radio refused for its size."""

    undelivered: Tuple[Payload, ...] = ()
    too_large: Optional[Tile] = None


DELIVERED = Outcome()


@dataclass(frozen=True, eq=False)
class Register:
    """Run the job, here or in another thread. Report its outcome with `Agent.on_registered`."""

    job: Job
    generation: int


@dataclass(frozen=True, eq=False)
class PublishMap:
    """The global map, and the box of its cells that differ from the one before; `boot` names the run whose frame it is
    in."""

    grid: OccupancyGrid
    changed: Box
    boot: Boot


class PublishPositions(NamedTuple):
    """The other robots with a known transform."""

    places: Tuple[Place, ...]


@dataclass(frozen=True, eq=False)
class PublishTrack:
    """Where a robot has been, own frame, shape (n, 2), metres, oldest first."""

    robot: str
    points: np.ndarray


class BroadcastTransforms(NamedTuple):
    """The transforms of the others' map frames to the own one."""

    transforms: Tuple[Tuple[str, Pose], ...]


class AskNeighbors(NamedTuple):
    """Ask the radio for its neighbours and report each with `Agent.on_robot`."""


@dataclass(frozen=True, eq=False)
class SaveDebugImages:
    """Write the map just sent and the one sent before."""

    present: OccupancyGrid
    before: OccupancyGrid


class Note(NamedTuple):
    """A text for people."""

    text: str
    warning: bool = False


Effect = Union[
    Send,
    Register,
    PublishMap,
    PublishPositions,
    PublishTrack,
    BroadcastTransforms,
    AskNeighbors,
    SaveDebugImages,
    Note,
]
