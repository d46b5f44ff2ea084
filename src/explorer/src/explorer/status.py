"""What the agent tells of itself, as plain values for nodes, recorders and pictures."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Mapping, Optional, Tuple

from mr_grid import Pose

Place = Tuple[float, float]


class State(IntEnum):
    """Values of `explorer/ExplorationState`.

    STARTING  until started, with map, pose         -> EXPLORING
    EXPLORING chooses or drives to a frontier       -> WAITING, RETURNING
    WAITING   frontiers are left, none for this robot now, or it is checked whether really none is left
    RETURNING finished, drives home                 -> FINISHED
    FINISHED  at rest
    """

    STARTING = 0
    EXPLORING = 1
    WAITING = 2
    RETURNING = 3
    FINISHED = 4


@dataclass(frozen=True)
class Counters:
    """Of one mission. `distance` in metres."""

    goals: int = 0
    goals_reached: int = 0
    goals_failed: int = 0
    auctions_completed: int = 0
    auctions_uncompleted: int = 0
    maps: int = 0
    distance: float = 0.0


@dataclass(frozen=True)
class Status:
    """The state of the robot in numbers; `exploration_time` in seconds, `goal` in the map frame."""

    robot: str
    state: State
    text: str
    finished: bool
    exploration_time: float
    goal: Optional[Pose]
    frontiers: int
    clusters: int
    unreachable: int
    counters: Counters


@dataclass(frozen=True)
class Picture:
    """Frontier points in metres in the own map frame: own ones, those visited, those of each other robot, and own ones
    by the number of their cluster."""

    own: Tuple[Place, ...]
    visited: Tuple[Place, ...]
    others: Mapping[str, Tuple[Place, ...]]
    clusters: Mapping[int, Tuple[Place, ...]]
