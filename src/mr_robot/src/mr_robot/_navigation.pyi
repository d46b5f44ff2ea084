"""Hot loops of the navigation engine (src/cpp/navigation). SI units, poses as (x, y, yaw)."""

from typing import Sequence

import numpy as np

_Pair = tuple[float, float]
_Pose = tuple[float, float, float]

TOUCHING: float
PROGRESS: float
SLACK: float
RAMP: float

class Limits:
    curvature: float
    def __init__(
        self, linear: float, angular: float, linear_acceleration: float, angular_acceleration: float
    ) -> None: ...

class Footprint:
    @property
    def half_length(self) -> float: ...
    @property
    def half_width(self) -> float: ...
    @property
    def radius(self) -> float: ...
    def __init__(self, half_length: float, half_width: float, radius: float = 0.0) -> None: ...
    def distance(self, x: float, y: float) -> float: ...

class Horizon:
    duration: float
    step: float
    goal_radius: float
    slack: float
    def __init__(self, duration: float) -> None: ...

class Agility:
    linear: float
    def __init__(self, limits: Limits) -> None: ...

def march(
    slowness: np.ndarray,
    seeds: Sequence[tuple[int, int, float]],
    stop: tuple[int, int] = ...,
    beyond: float = ...,
    limit: float = ...,
    former: tuple[np.ndarray, np.ndarray] | None = ...,
) -> np.ndarray: ...
def hits(
    ranges: Sequence[float] | np.ndarray, directions: np.ndarray, range_min: float, range_max: float, mount: _Pair
) -> tuple[np.ndarray, np.ndarray]: ...

class Inflation:
    def __init__(self, least: float, most: float, wall_cost: float) -> None: ...

def inflate(
    cells: np.ndarray, resolution: float, inflation: Inflation, unknown_blocks: bool
) -> tuple[np.ndarray, np.ndarray]: ...
def slower_around(
    slowness: np.ndarray, obstacles: np.ndarray, resolution: float, inflation: Inflation
) -> np.ndarray: ...
def descend(cost: np.ndarray, cell: tuple[int, int], most: int) -> list[tuple[int, int]]: ...

class Map:
    def __init__(self, cells: np.ndarray, resolution: float, origin: _Pair) -> None: ...

class Walls:
    resolution: float
    same_surface: float
    def __init__(self, cells: np.ndarray, distance: np.ndarray, resolution: float, origin: _Pair) -> None: ...

class Memory:
    def __init__(self, duration: float, cell: float, most: int) -> None: ...

class Margins:
    def __init__(self, wall: float, foreign: float, obstacle: float, moving: float, reaction_time: float) -> None: ...

def remember(
    old: np.ndarray,
    points: np.ndarray,
    ranges: np.ndarray,
    angle_min: float,
    angle_increment: float,
    range_min: float,
    mount: _Pose,
    pose: _Pose,
    walls: Walls,
    memory: Memory,
    now: float,
) -> np.ndarray: ...
def surroundings(
    points: np.ndarray,
    pose: _Pose,
    remembered: np.ndarray,
    walls: Walls,
    own: Map | None,
    footprint: Footprint,
    margins: Margins,
    reach: float,
    ranges: np.ndarray = ...,
    angle_min: float = ...,
    angle_increment: float = ...,
    mount: _Pose = ...,
) -> np.ndarray: ...
def outside(pose: _Pose, obstacles: np.ndarray, footprint: Footprint) -> np.ndarray: ...
def choose_velocity(
    cost: np.ndarray,
    resolution: float,
    origin: _Pair,
    goal: _Pair,
    pose: _Pose,
    velocity: _Pair,
    obstacles: np.ndarray,
    limits: Limits,
    footprint: Footprint,
    horizon: Horizon,
    period: float,
) -> tuple[bool, float, float, float, float]: ...
def manoeuvre(
    cost: np.ndarray,
    cells: np.ndarray,
    resolution: float,
    origin: _Pair,
    goal: _Pair,
    pose: _Pose,
    obstacles: np.ndarray,
    footprint: Footprint,
    agility: Agility,
    known: float,
    slack: float = ...,
) -> np.ndarray: ...
def turn_wanted(cost: np.ndarray, resolution: float, origin: _Pair, goal: _Pair, pose: _Pose) -> float: ...
def has_room_to_turn(pose: _Pose, obstacles: np.ndarray, footprint: Footprint) -> bool: ...
def is_clear(
    pose: _Pose,
    velocity: _Pair,
    target: _Pair,
    obstacles: np.ndarray,
    limits: Limits,
    footprint: Footprint,
    horizon: Horizon,
) -> bool: ...
def clearance(pose: _Pose, obstacles: np.ndarray, footprint: Footprint) -> float: ...
