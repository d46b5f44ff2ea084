"""What the agent wants done. The host carries these out and reports back where stated."""

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple, Tuple, Union

import numpy as np

from .grid import Grid
from .job import Job
from .messages import Payload
from .transform import Transform


class Purpose(Enum):
    """Why something is sent."""

    CHANGES = "changes"
    ANSWER = "answer"
    REQUEST = "request"
    POSITION = "position"
    ANCHOR = "anchor"


@dataclass(frozen=True, eq=False)
class Send:
    """Send the payloads in order to a robot or group; stop at the first that fails. Report with `Agent.on_sent`."""

    number: int
    purpose: Purpose
    destination: str
    payloads: Tuple[Payload, ...]


@dataclass(frozen=True, eq=False)
class Register:
    """Run the job, here or in another thread. Report its outcome with `Agent.on_registered`."""

    job: Job
    generation: int


@dataclass(frozen=True, eq=False)
class PublishMap:
    """The global map changed."""

    grid: Grid


class Place(NamedTuple):
    """Where a robot is in the own frame, metres."""

    robot: str
    x: float
    y: float


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

    transforms: Tuple[Tuple[str, Transform], ...]


class AskNeighbors(NamedTuple):
    """Ask the radio for its neighbours and report each with `Agent.on_robot`."""


@dataclass(frozen=True, eq=False)
class SaveDebugImages:
    """Write the map just sent and the one sent before."""

    present: Grid
    before: Grid


class Note(NamedTuple):
    """A text for people."""

    text: str
    warning: bool = False


Effect = Union[
    Send, Register, PublishMap, PublishPositions, PublishTrack, BroadcastTransforms, AskNeighbors, SaveDebugImages, Note
]
